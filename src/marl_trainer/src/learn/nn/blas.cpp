#include "marl_trainer/learn/nn/blas.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <vector>

// The Fortran interface: every BLAS of the system has it, and it needs no header.
extern "C" void sgemm_(const char* transpose_a, const char* transpose_b, const int* m, const int* n,
                       const int* k, const float* alpha, const float* a, const int* lda,
                       const float* b, const int* ldb, const float* beta, float* c, const int* ldc);

namespace stg::learn {

void UseOneBlasThread() {
  // Found at run time, because the reference BLAS, which works, too, has no such function.
  using SetThreads = void (*)(int);
  if (void* symbol = dlsym(RTLD_DEFAULT, "openblas_set_num_threads")) {
    reinterpret_cast<SetThreads>(symbol)(1);
  }
}

void Multiply(bool transpose_a, bool transpose_b, int m, int n, int k, const float* a,
              const float* b, float beta, float* c) {
  // BLAS is column-major and sees the transposes: C^T = op(B)^T op(A)^T.
  const float alpha = 1.0F;
  const int lda = transpose_a ? m : k, ldb = transpose_b ? k : n;
  sgemm_(transpose_b ? "T" : "N", transpose_a ? "T" : "N", &n, &m, &k, &alpha, b, &ldb, a, &lda,
         &beta, c, &n);
}

void MultiplyColumns(int m, int n, int k, const float* a, const float* b, int stride, float* c) {
  const float alpha = 1.0F, beta = 0.0F;
  sgemm_("N", "N", &n, &m, &k, &alpha, b, &stride, a, &k, &beta, c, &n);
}

double MeasurePeakFlops() {
  constexpr int kSize = 512;
  constexpr int kRepeats = 6;
  const std::vector<float> a(kSize * kSize, 0.5F), b(kSize * kSize, 0.25F);
  std::vector<float> c(kSize * kSize, 0.0F);
  double best = 0.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    Multiply(false, false, kSize, kSize, kSize, a.data(), b.data(), 0.0F, c.data());
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::max(best, 2.0 * kSize * kSize * kSize / took.count());
  }
  return best;
}

}  // namespace stg::learn
