#pragma once

#include <cstddef>
#include <cstring>

#include "auv_common/numbers/lanes.hpp"

/// One lane of a structure S<T>. All members of S are numbers T, or structures of such members,
/// such as Vec3<T>.
namespace stg {

namespace lane_structs {

template <template <class> class S>
inline constexpr std::size_t kNumbers = sizeof(S<double>) / sizeof(double);

template <template <class> class S>
constexpr void Check() {
  static_assert(sizeof(S<Pack>) == sizeof(Pack) * kNumbers<S>, "all members are numbers");
}

template <template <class> class S>
inline char* At(S<Pack>* packs, std::size_t number, int lane) {
  return reinterpret_cast<char*>(packs) + number * sizeof(Pack) +
         static_cast<std::size_t>(lane) * sizeof(double);
}

}  // namespace lane_structs

template <template <class> class S>
inline S<double> LaneOf(const S<Pack>& packs, int lane) {
  lane_structs::Check<S>();
  const char* from =
      reinterpret_cast<const char*>(&packs) + static_cast<std::size_t>(lane) * sizeof(double);
  S<double> out;
  char* to = reinterpret_cast<char*>(&out);
  for (std::size_t k = 0; k < lane_structs::kNumbers<S>; ++k) {
    std::memcpy(to + k * sizeof(double), from + k * sizeof(Pack), sizeof(double));
  }
  return out;
}
template <template <class> class S>
inline const S<double>& LaneOf(const S<double>& numbers, int) {
  return numbers;
}

template <template <class> class S>
inline void SetLaneOf(S<Pack>* packs, int lane, const S<double>& numbers) {
  lane_structs::Check<S>();
  const char* from = reinterpret_cast<const char*>(&numbers);
  for (std::size_t k = 0; k < lane_structs::kNumbers<S>; ++k) {
    std::memcpy(lane_structs::At(packs, k, lane), from + k * sizeof(double), sizeof(double));
  }
}
template <template <class> class S>
inline void SetLaneOf(S<double>* to, int, const S<double>& numbers) {
  *to = numbers;
}

/// Restores the lanes outside the mask from `before`.
inline void KeepOthers(const Mask<Pack>& lanes, const Pack& before, Pack* now) {
  *now = Select(lanes, *now, before);
}
inline void KeepOthers(bool lanes, double before, double* now) {
  if (!lanes) *now = before;
}
template <template <class> class S>
inline void KeepOthers(const Mask<Pack>& lanes, const S<Pack>& before, S<Pack>* now) {
  for (std::size_t k = 0; k < lane_structs::kNumbers<S>; ++k) {
    Pack was, is;
    std::memcpy(&was, reinterpret_cast<const char*>(&before) + k * sizeof(Pack), sizeof(Pack));
    std::memcpy(&is, lane_structs::At(now, k, 0), sizeof(Pack));
    KeepOthers(lanes, was, &is);
    std::memcpy(lane_structs::At(now, k, 0), &is, sizeof(Pack));
  }
}
template <template <class> class S>
inline void KeepOthers(bool lanes, const S<double>& before, S<double>* now) {
  if (!lanes) *now = before;
}

}  // namespace stg
