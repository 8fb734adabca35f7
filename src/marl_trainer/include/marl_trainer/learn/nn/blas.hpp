#pragma once

/// Single-precision matrix products on row-major arrays, by the system's BLAS.
namespace stg::learn {

/// One thread per call for BLAS: parallelism is over workers. Call once, early.
void UseOneBlasThread();

/// C = op(A) op(B) + beta C, with op(A) [m, k], op(B) [k, n], C [m, n], all
/// row-major and without gaps.
void Multiply(bool transpose_a, bool transpose_b, int m, int n, int k, const float* a,
              const float* b, float beta, float* c);

/// C = A B for n columns of a wider B: A [m, k], rows of B `stride` numbers apart, C [m, n].
void MultiplyColumns(int m, int n, int k, const float* a, const float* b, int stride, float* c);

/// Measured rate of one thread on square products of 512 [floating-point
/// operations per second]: the peak that an update is compared with.
double MeasurePeakFlops();

}  // namespace stg::learn
