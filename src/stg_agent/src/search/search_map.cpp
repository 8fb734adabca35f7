#include "stg_agent/search/search_map.hpp"

#include <algorithm>
#include <cmath>

namespace stg::agent {
namespace {

/// Remaining share of the probability of a cell that contradicts a detection, because the detection
/// may be false.
constexpr double kDoubt = 0.01;

}  // namespace

SearchMap::SearchMap(const AgentModel& s)
    : cell_m_(s.track.search_cell_m),
      range_m_(s.sensing.range_m),
      probability_(s.sensing.detection_probability),
      at_range_(s.sensing.relative().probability_at_range),
      workspace_m_(s.workspace.half_extent_m) {
  const double speed = s.track.velocity_std_mps > 0.0 ? s.track.velocity_std_mps
                                                      : s.target.max_speed_mps * std::sqrt(0.5);
  diffusivity_ = 2.0 * speed * speed * s.track.velocity_memory_s;
}

void SearchMap::Start(const dynamics::Cue& cue) {
  // Around the datum, within the workspace.
  const double room = std::max(0.0, workspace_m_ - half_m());
  x0_ = Clip(cue.p_WT.x, -room, room) - half_m();
  y0_ = Clip(cue.p_WT.y, -room, room) - half_m();
  time_ = 0;
  const double std_m = std::max(cue.std_m, 0.5 * cell_m_);
  const auto weight = [std_m](double off) { return std::exp(-0.5 * off * off / (std_m * std_m)); };
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      mass_[static_cast<std::size_t>(r * kSide + c)] =
          weight(x(c) - cue.p_WT.x) * weight(y(r) - cue.p_WT.y);
    }
  }
  const auto first_inside = [this](double start) {
    return std::max(0, static_cast<int>(std::ceil((-workspace_m_ - start) / cell_m_ - 0.5)));
  };
  const auto last_inside = [this](double start) {
    return std::min(kSide - 1,
                    static_cast<int>(std::floor((workspace_m_ - start) / cell_m_ - 0.5)));
  };
  column_lo_ = first_inside(x0_);
  column_hi_ = last_inside(x0_);
  row_lo_ = first_inside(y0_);
  row_hi_ = last_inside(y0_);
  Normalise();
}

void SearchMap::Advance(TimeNs now) {
  const double passed_s = Seconds(now - time_);
  if (passed_s < kStep_s) return;
  Spread(passed_s);
  time_ = now;
}

double SearchMap::DetectionProbability(double range_m) const {
  if (range_m > range_m_) return 0.0;
  const double share = range_m / range_m_;
  return probability_ * (1.0 - (1.0 - at_range_) * share * share);
}

void SearchMap::LookInVain(const Vec3<double>& p_WO) {
  const auto cell = [this](double off) {
    return static_cast<int>(std::floor(Clip(off / cell_m_, -1.0, static_cast<double>(kSide))));
  };
  const int r0 = std::max(0, cell(p_WO.y - range_m_ - y0_));
  const int r1 = std::min(kSide - 1, cell(p_WO.y + range_m_ - y0_));
  const int c0 = std::max(0, cell(p_WO.x - range_m_ - x0_));
  const int c1 = std::min(kSide - 1, cell(p_WO.x + range_m_ - x0_));
  for (int r = r0; r <= r1; ++r) {
    for (int c = c0; c <= c1; ++c) {
      double& mass = mass_[static_cast<std::size_t>(r * kSide + c)];
      const double found = mass * DetectionProbability(std::hypot(x(c) - p_WO.x, y(r) - p_WO.y));
      mass -= found;
      total_ -= found;
    }
  }
  if (total_ < 1e-3) Normalise();
}

void SearchMap::Find(const dynamics::Detection& d) {
  if (d.kind == dynamics::MeasurementKind::kBearing) return;
  const bool ring = d.kind == dynamics::MeasurementKind::kRange;
  const Vec3<double>& p = ring ? d.p_WO : d.p_WT;
  const double range = ring ? d.range_m : 0.0;
  const double error = ring ? d.range_std_m : d.std_m;
  // The position within a cell is uncertain, too.
  const double std_m =
      std::sqrt(error * error + d.p_WO_std_m * d.p_WO_std_m + cell_m_ * cell_m_ / 6.0);
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      const double off = (std::hypot(x(c) - p.x, y(r) - p.y) - range) / std_m;
      mass_[static_cast<std::size_t>(r * kSide + c)] *= kDoubt + std::exp(-0.5 * off * off);
    }
  }
  Normalise();
}

void SearchMap::Spread(double time_s) {
  // One step of a random walk to the neighbouring cells, on either axis: its variance is 2 w
  // cell^2. Nothing crosses the edges of the workspace and of the map.
  const double w = std::min(1.0 / 3.0, 0.5 * diffusivity_ * time_s / (cell_m_ * cell_m_));
  const auto along = [&](int offset, int stride, int lo, int hi) {
    const auto at = [&](int k) -> double& {
      return mass_[static_cast<std::size_t>(offset + k * stride)];
    };
    double before = at(lo);
    for (int k = lo; k <= hi; ++k) {
      const double here = at(k), after = at(std::min(k + 1, hi));
      at(k) = here + w * (before - 2.0 * here + after);
      before = here;
    }
  };
  for (int r = row_lo_; r <= row_hi_; ++r) along(r * kSide, 1, column_lo_, column_hi_);
  for (int c = column_lo_; c <= column_hi_; ++c) along(c, kSide, row_lo_, row_hi_);
  Normalise();
}

void SearchMap::Normalise() {
  double total = 0.0;
  for (int r = 0; r < kSide; ++r) {
    for (int c = 0; c < kSide; ++c) {
      double& mass = mass_[static_cast<std::size_t>(r * kSide + c)];
      if (!Inside(r, c)) mass = 0.0;
      total += mass;
    }
  }
  // If the datum is far outside of the map, or every cell was searched without result, the target
  // may be anywhere.
  for (double& mass : mass_) mass = total > 1e-200 ? mass / total : 1.0 / kCells;
  total_ = 1.0;
}

}  // namespace stg::agent
