#pragma once

#if defined(__AVX__) && !defined(__AVX512F__)
#include <immintrin.h>
#endif

#include <algorithm>
#include <cstddef>
#include <type_traits>

#include "auv_common/numbers/lanes.hpp"

namespace stg::env {

/// The reverse of Scatter: columns of packs from one row per lane. Lanes without a row are 0.
template <class Number>
inline void Gather(const Number* rows, std::size_t stride, int lanes, int size, Pack* columns) {
  int c = 0;
#if defined(__AVX__) && !defined(__AVX512F__)
  if constexpr (std::is_same_v<Number, float>) {
    for (; lanes == kLanes && size >= 4 && c < size; c += 4) {
      const int k = std::min(c, size - 4);
      const float* row = rows + k;
      __m128 r0 = _mm_loadu_ps(row);
      __m128 r1 = _mm_loadu_ps(row + stride);
      __m128 r2 = _mm_loadu_ps(row + 2 * stride);
      __m128 r3 = _mm_loadu_ps(row + 3 * stride);
      _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
      columns[k] = _mm256_cvtps_pd(r0);
      columns[k + 1] = _mm256_cvtps_pd(r1);
      columns[k + 2] = _mm256_cvtps_pd(r2);
      columns[k + 3] = _mm256_cvtps_pd(r3);
    }
  }
#endif
  for (; c < size; ++c) {
    alignas(Pack) double buffer[kLanes] = {};
    for (int lane = 0; lane < lanes; ++lane) {
      buffer[lane] = static_cast<double>(
          rows[static_cast<std::size_t>(lane) * stride + static_cast<std::size_t>(c)]);
    }
    columns[c] = Pack::load_aligned(buffer);
  }
}

/// Turns columns of packs into one float row per lane.
/// @param columns [size]
/// @param rows start of the first lane's row; the next lane's row starts `stride` numbers later
/// @param lanes number of rows to write, for the first lanes of the packs
inline void Scatter(const Pack* columns, int size, int lanes, float* rows, std::size_t stride) {
  int c = 0;
#if defined(__AVX__) && !defined(__AVX512F__)
  // Four columns of four lanes at a time: a quarter of the time of single stores. The last four may
  // overlap the four before.
  static_assert(kLanes == 4, "AVX holds four doubles");
  for (; lanes == kLanes && size >= 4 && c < size; c += 4) {
    const int k = std::min(c, size - 4);
    float* row = rows + k;
    __m128 r0 = _mm256_cvtpd_ps(columns[k]);
    __m128 r1 = _mm256_cvtpd_ps(columns[k + 1]);
    __m128 r2 = _mm256_cvtpd_ps(columns[k + 2]);
    __m128 r3 = _mm256_cvtpd_ps(columns[k + 3]);
    _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
    _mm_storeu_ps(row, r0);
    _mm_storeu_ps(row + stride, r1);
    _mm_storeu_ps(row + 2 * stride, r2);
    _mm_storeu_ps(row + 3 * stride, r3);
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
