#include "stg_env/task/estimate_totals.hpp"

#include <algorithm>
#include <cmath>

namespace stg::task {
namespace {

constexpr double kFirstBin_m = 0.01, kBinGrowth = 1.05;

int BinOf(double error_m, int bins) {
  const double k = std::log(std::max(error_m, kFirstBin_m) / kFirstBin_m) / std::log(kBinGrowth);
  return static_cast<int>(Clip(k, 0.0, bins - 1.0));
}

/// Upper end of the bin below which this share of the counted values lies; 0: nothing was counted.
template <class Histogram>
double Quantile(const Histogram& counts, double share) {
  std::uint64_t all = 0, below = 0;
  for (const std::uint32_t c : counts) all += c;
  if (all == 0) return 0.0;
  for (std::size_t k = 0; k < counts.size(); ++k) {
    below += counts[k];
    if (static_cast<double>(below) >= share * static_cast<double>(all)) {
      return kFirstBin_m * std::pow(kBinGrowth, static_cast<double>(k) + 1.0);
    }
  }
  return 0.0;
}

template <class T>
T Off(const agent::TaskConfig& task, const FieldState<T>& field, const Vec3<T>& error) {
  if (task.lost_error_m <= 0.0) return T(0.0);
  const auto off = (field.known < T(0.5)) || (Norm(error) > T(task.lost_error_m));
  return Select(off, T(1.0), T(0.0));
}

}  // namespace

std::vector<std::pair<std::string, double>> EstimateMetrics::Items() const {
  return {{"own_rmse", own_rmse},
          {"own_rmse_tail", own_rmse_tail},
          {"own_95", own_95},
          {"world_rmse", world_rmse},
          {"world_rmse_tail", world_rmse_tail},
          {"world_95", world_95},
          {"vertical_rmse", vertical_rmse},
          {"lost_in_world", lost_in_world}};
}

template <class T>
T OffInOwnFrame(const agent::TaskConfig& task, const FieldState<T>& field, const Vec3<T>& r_BT_W) {
  return Off(task, field, field.r_BT_W - r_BT_W);
}

template <class T>
T OffInWorld(const agent::TaskConfig& task, const FieldState<T>& field, const Vec3<T>& p_WT) {
  return Off(task, field, field.p_WT - p_WT);
}

template <class T>
EstimateTotals<T>::EstimateTotals(const JudgeConfig& scenario)
    : scenario_(scenario), own_(static_cast<std::size_t>(kLanesOf<T>), Histogram{}), world_(own_) {}

template <class T>
void EstimateTotals<T>::Start(const Mask<T>& lanes) {
  Sums& s = sums_;
  for (T* sum : {&s.present, &s.known, &s.known_tail, &s.own, &s.own_tail, &s.world, &s.world_tail,
                 &s.vertical, &s.lost_in_world}) {
    *sum = Select(lanes, T(0.0), *sum);
  }
  const T starting = Select(lanes, T(1.0), T(0.0));
  for (int lane = 0; lane < kLanesOf<T>; ++lane) {
    if (Lane(starting, lane) == 0.0) continue;
    own_[static_cast<std::size_t>(lane)].fill(0);
    world_[static_cast<std::size_t>(lane)].fill(0);
  }
}

template <class T>
void EstimateTotals<T>::Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking,
                            const Mask<T>& tail) {
  const T zero(0.0), one(1.0);
  Sums& s = sums_;
  for (std::size_t i = 0; i < tracking.size(); ++i) {
    const FieldState<T>& f = (*swarm.field)[i];
    const Tracking<T>& k = tracking[i];
    const Vec3<T>& p_WT = swarm.target_of(i).p_WT;
    const Vec3<T> own = f.r_BT_W - k.r_BT_W, world = f.p_WT - p_WT;
    const auto there = f.present > T(0.5);
    const auto known = (f.known > T(0.5)) && there;
    s.present += f.present;
    const T own2 = Select(known, own.x * own.x + own.y * own.y, zero);
    const T world2 = Select(known, world.x * world.x + world.y * world.y, zero);
    s.known += Select(known, one, zero);
    s.own += own2;
    s.world += world2;
    s.vertical += Select(known, world.z * world.z, zero);
    s.known_tail += Select(tail && known, one, zero);
    s.own_tail += Select(tail, own2, zero);
    s.world_tail += Select(tail, world2, zero);
    const auto far = k.distance > T(scenario_.agent.task.lost_distance_m);
    s.lost_in_world +=
        Select(there, Select(far, one, OffInWorld(scenario_.agent.task, f, p_WT)), zero);
    for (int lane = 0; lane < kLanesOf<T>; ++lane) {
      if (Lane(f.known, lane) > 0.5 && Lane(f.present, lane) > 0.5) {
        Count(lane, std::sqrt(Lane(own2, lane)), std::sqrt(Lane(world2, lane)));
      }
    }
  }
}

template <class T>
void EstimateTotals<T>::Count(int lane, double own_m, double world_m) {
  const auto u = static_cast<std::size_t>(lane);
  ++own_[u][static_cast<std::size_t>(BinOf(own_m, kBins))];
  ++world_[u][static_cast<std::size_t>(BinOf(world_m, kBins))];
}

template <class T>
EstimateMetrics EstimateTotals<T>::Metrics(int lane) const {
  const Sums& s = sums_;
  const auto root = [lane](const T& sum, const T& count) {
    return std::sqrt(Lane(sum, lane) / std::max(1.0, Lane(count, lane)));
  };
  const auto u = static_cast<std::size_t>(lane);
  EstimateMetrics m;
  m.own_rmse = root(s.own, s.known);
  m.own_rmse_tail = root(s.own_tail, s.known_tail);
  m.own_95 = Quantile(own_[u], 0.95);
  m.world_rmse = root(s.world, s.known);
  m.world_rmse_tail = root(s.world_tail, s.known_tail);
  m.world_95 = Quantile(world_[u], 0.95);
  m.vertical_rmse = root(s.vertical, s.known);
  m.lost_in_world = Lane(s.lost_in_world, lane) / std::max(1.0, Lane(s.present, lane));
  return m;
}

template class EstimateTotals<double>;
template class EstimateTotals<Pack>;
template double OffInOwnFrame(const agent::TaskConfig&, const FieldState<double>&,
                              const Vec3<double>&);
template Pack OffInOwnFrame(const agent::TaskConfig&, const FieldState<Pack>&, const Vec3<Pack>&);
template double OffInWorld(const agent::TaskConfig&, const FieldState<double>&,
                           const Vec3<double>&);
template Pack OffInWorld(const agent::TaskConfig&, const FieldState<Pack>&, const Vec3<Pack>&);

}  // namespace stg::task
