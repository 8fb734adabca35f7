#pragma once

#if defined(__AVX__) && !defined(__AVX512F__)
#include <immintrin.h>
#endif

#include <cstddef>
#include <type_traits>

#include "auv_common/numbers/lanes.hpp"

namespace stg::env {

/// The reverse of Scatter: columns of packs from one row per lane. Lanes beyond are 0.
template <class Number>
inline void Gather(const Number* rows, std::size_t stride, int lanes, int size, Pack* columns) {
  int c = 0;
#if defined(__AVX__) && !defined(__AVX512F__)
  if constexpr (std::is_same_v<Number, float>) {
    for (; lanes == kLanes && c + 4 <= size; c += 4) {
      __m128 r0 = _mm_loadu_ps(rows + c);
      __m128 r1 = _mm_loadu_ps(rows + stride + c);
      __m128 r2 = _mm_loadu_ps(rows + 2 * stride + c);
      __m128 r3 = _mm_loadu_ps(rows + 3 * stride + c);
      _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
      columns[c] = _mm256_cvtps_pd(r0);
      columns[c + 1] = _mm256_cvtps_pd(r1);
      columns[c + 2] = _mm256_cvtps_pd(r2);
      columns[c + 3] = _mm256_cvtps_pd(r3);
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
