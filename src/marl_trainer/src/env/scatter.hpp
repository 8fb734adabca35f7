#pragma once

#if defined(__AVX__) && !defined(__AVX512F__)
#include <immintrin.h>
#endif

#include <cstddef>

#include "auv_common/numbers/lanes.hpp"

namespace stg::env {

/// Turns columns of packs into one float row per lane.
/// @param columns [size]
/// @param rows where the first lane's row begins; the next lane's begins `stride` numbers later
/// @param lanes rows to write, the first lanes of the packs
inline void Scatter(const Pack* columns, int size, int lanes, float* rows, std::size_t stride) {
  int c = 0;
#if defined(__AVX__) && !defined(__AVX512F__)
  // Four columns of four lanes at a time: a quarter of the time of single stores.
  static_assert(kLanes == 4, "AVX holds four doubles");
  for (; lanes == kLanes && c + 4 <= size; c += 4) {
    __m128 r0 = _mm256_cvtpd_ps(columns[c]);
    __m128 r1 = _mm256_cvtpd_ps(columns[c + 1]);
    __m128 r2 = _mm256_cvtpd_ps(columns[c + 2]);
    __m128 r3 = _mm256_cvtpd_ps(columns[c + 3]);
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
    _mm_storeu_ps(rows + c, r0);
    _mm_storeu_ps(rows + stride + c, r1);
    _mm_storeu_ps(rows + 2 * stride + c, r2);
    _mm_storeu_ps(rows + 3 * stride + c, r3);
  }
#endif
  alignas(64) double buffer[kLanes];
  for (; c < size; ++c) {
    columns[c].store_aligned(buffer);
    for (int lane = 0; lane < lanes; ++lane) {
      rows[static_cast<std::size_t>(lane) * stride + static_cast<std::size_t>(c)] =
          static_cast<float>(buffer[lane]);
    }
  }
}

}  // namespace stg::env
