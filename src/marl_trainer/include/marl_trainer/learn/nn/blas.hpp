#pragma once

/// Single-precision matrix products on row-major arrays, by the system's BLAS.
namespace stg::learn {

/// Makes BLAS use one thread per call, because the workers run in parallel. Call it once, early.
void UseOneBlasThread();

/// C = op(A) op(B) + beta C with op(A) [m, k], op(B) [k, n] and C [m, n]. All are row-major without
/// gaps.
void Multiply(bool transpose_a, bool transpose_b, int m, int n, int k, const float* a,
              const float* b, float beta, float* c);

/// C = A B for n columns of a wider B: A [m, k], C [m, n]; rows of B are `stride` numbers apart.
void MultiplyColumns(int m, int n, int k, const float* a, const float* b, int stride, float* c);

/// Measured rate of one thread for products of square matrices of size 512 [floating-point
/// operations per second]. It is the peak with which an update is compared.
double MeasurePeakFlops();

}  // namespace stg::learn
