#include <algorithm>
#include <array>
#include <cmath>

#include "auv_common/numbers/attitude.hpp"
#include "auv_common/numbers/vector.hpp"
#include "stg_agent/entities/entities.hpp"

namespace stg::agent {
namespace {

constexpr int kSectors = 8;
constexpr std::array<double, 3> kRings_m = {400.0, 900.0, 2000.0};

}  // namespace

void BuildSearchRow(const SearchMap& map, const Vec3<double>& p_WB, double cos_course,
                    double sin_course, double sensor_m, float* out) {
  std::array<double, kSectors * kRings_m.size()> mass{};
  double within = 0.0, entropy = 0.0, most = -1.0, best_x = 1.0, best_y = 0.0;
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      const double m = map.mass(r, c);
      if (m < 1e-9) continue;
      const double east = map.x(c) - p_WB.x, north = map.y(r) - p_WB.y;
      const double x = cos_course * east + sin_course * north;
      const double y = cos_course * north - sin_course * east;
      const double d = std::hypot(x, y);
      entropy -= m * std::log(m);
      if (d <= sensor_m) within += m;
      if (m > most) {
        most = m;
        best_x = d > 1e-6 ? x / d : 1.0;
        best_y = d > 1e-6 ? y / d : 0.0;
      }
      std::size_t ring = 0;
      while (ring < kRings_m.size() && d > kRings_m[ring]) ++ring;
      if (ring == kRings_m.size()) continue;
      const auto sector = static_cast<int>(std::lround(std::atan2(y, x) * kSectors / (2.0 * kPi)));
      mass[ring * kSectors + static_cast<std::size_t>((sector + kSectors) % kSectors)] += m;
    }
  }
  for (const double m : mass) *out++ = static_cast<float>(std::sqrt(m));
  *out++ = static_cast<float>(within);
  *out++ = static_cast<float>(entropy / std::log(static_cast<double>(SearchMap::kCells)));
  *out++ = static_cast<float>(best_x);
  *out++ = static_cast<float>(best_y);
}

}  // namespace stg::agent
