#include <algorithm>
#include <array>
#include <cmath>

#include "set_distance.hpp"
#include "stg_agent/agent/entity_memory.hpp"
#include "stg_env/task/field_totals.hpp"

namespace stg::task {
namespace {

constexpr double kWindow_s = 600.0;
constexpr double kGood_m = 20.0;  // largest error of a good estimate

template <class T>
T Level(const Vec3<T>& r) {
  return Sqrt(r.x * r.x + r.y * r.y);
}

}  // namespace

std::vector<std::pair<std::string, double>> SearchMetrics::Items() const {
  std::vector<std::pair<std::string, double>> items{{"found", found},
                                                    {"time_to_detect", time_to_detect},
                                                    {"time_to_gather", time_to_gather},
                                                    {"info_spread", info_spread},
                                                    {"followed", followed},
                                                    {"worst_followed", worst_followed},
                                                    {"target_net_speed", target_net_speed}};
  if (choices) {
    items.insert(
        items.end(),
        {{"switches", choices->switches}, {"ospa", choices->ospa}, {"gospa", choices->gospa}});
    if (choices->nearest_error) items.emplace_back("nearest_error", *choices->nearest_error);
    if (choices->swaps) items.emplace_back("swaps", *choices->swaps);
  }
  return items;
}

template <class T>
SearchTotals<T>::SearchTotals(const JudgeConfig& scenario)
    : scenario_(scenario),
      window_(std::max(1.0, std::round(kWindow_s / scenario.run.decision_dt_s()))),
      targets_(static_cast<std::size_t>(scenario.world.target.count)),
      chosen_(static_cast<std::size_t>(scenario.run.agents), T(-1.0)) {
  if (!scenario.world.sensing.labelled) of_.assign(chosen_.size() * targets_.size(), T(-1.0));
  const int agents = scenario.run.agents, targets = scenario.world.target.count;
  for (int t = 0; t < targets; ++t) {
    const int team = scenario.agent.task.free() ? std::max(1, agents / targets)
                                                : (agents - t + targets - 1) / targets;
    targets_[static_cast<std::size_t>(t)].wanted = std::min(2, std::max(team, 0));
  }
}

template <class T>
void SearchTotals<T>::Start(const Mask<T>& lanes) {
  const auto restart = [&](T* value, double first) { *value = Select(lanes, T(first), *value); };
  restart(&decisions_, 0.0);
  restart(&gathered_, -1.0);
  restart(&info_spread_, 0.0);
  for (T* sum : {&switches_, &swaps_, &judged_, &ospa_, &gospa_, &nearest_, &nearest_known_}) {
    restart(sum, 0.0);
  }
  for (T& chosen : chosen_) restart(&chosen, -1.0);
  for (T& of : of_) restart(&of, -1.0);
  for (OfTarget& t : targets_) {
    restart(&t.detected, -1.0);
    for (T* sum : {&t.followed, &t.way, &t.net, &t.window_way}) restart(sum, 0.0);
  }
}

template <class T>
T SearchTotals<T>::InBand(const Tracking<T>& k) const {
  const config::Interval& band = scenario_.reward.band_m;
  return Select((k.distance <= T(band.hi)) && (k.distance >= T(band.lo)), T(1.0), T(0.0));
}

template <class T>
void SearchTotals<T>::Follow(const Vec3<T>& p_WT, OfTarget* t) const {
  const auto first = decisions_ < T(1.5);  // the way from the start is unknown
  t->window_way = Select(first, T(0.0), t->window_way + Level(p_WT - t->p_WT));
  t->p_window = Select<T>(first, p_WT, t->p_window);
  t->p_WT = p_WT;
  const T windows = decisions_ - T(1.0);
  const auto over =
      (windows > T(0.5)) && (windows - Floor(windows / T(window_)) * T(window_) < T(0.5));
  t->way += Select(over, t->window_way, T(0.0));
  t->net += Select(over, Level(p_WT - t->p_window), T(0.0));
  t->window_way = Select(over, T(0.0), t->window_way);
  t->p_window = Select<T>(over, p_WT, t->p_window);
}

/// Counts the estimates of AUV i that now are of another target than when they were last good. An
/// estimate is good if it is near one target and not near another one.
template <class T>
void SearchTotals<T>::AddSwaps(const SwarmState<T>& swarm, std::size_t i) {
  const Following<T>& f = *swarm.following;
  const std::size_t n = targets_.size();
  for (std::size_t k = i * n; k < (i + 1) * n; ++k) {
    for (int lane = 0; lane < kLanesOf<T>; ++lane) {
      if (Lane(f.known[k], lane) < 0.5) continue;
      int near = -1, doubtful = 0;
      for (std::size_t t = 0; t < n; ++t) {
        const double apart = Level(Lane(f.p_WT[k], lane) - Lane(swarm.targets[t].p_WT, lane));
        if (apart < kGood_m) near = static_cast<int>(t);
        if (apart < 2.0 * kGood_m) ++doubtful;
      }
      if (near < 0 || doubtful > 1) continue;
      const double before = Lane(of_[k], lane);
      if (before >= 0.0 && before != near) SetLane(&swaps_, lane, Lane(swaps_, lane) + 1.0);
      SetLane(&of_[k], lane, static_cast<double>(near));
    }
  }
}

/// Adds the error of each target's estimate by the AUV that is nearest to the target.
template <class T>
void SearchTotals<T>::AddNearest(const SwarmState<T>& swarm) {
  const Following<T>& f = *swarm.following;
  const std::size_t n = targets_.size();
  for (std::size_t t = 0; t < n; ++t) {
    const Vec3<T>& p_WT = swarm.targets[t].p_WT;
    T least(1e9), error(0.0), known(0.0);
    for (std::size_t i = 0; i < chosen_.size(); ++i) {
      const T apart = Level(swarm.vehicles[i].p_WB - p_WT);
      const auto nearer = (apart < least) && ((*swarm.field)[i].present > T(0.5));
      least = Select(nearer, apart, least);
      error = Select(nearer, Level(f.p_WT[i * n + t] - p_WT), error);
      known = Select(nearer, f.known[i * n + t], known);
    }
    nearest_ += Select(known > T(0.5), error, T(0.0));
    nearest_known_ += known;
  }
}

template <class T>
void SearchTotals<T>::AddChoices(const SwarmState<T>& swarm) {
  const Following<T>& f = *swarm.following;
  const T zero(0.0), one(1.0);
  const std::size_t n = targets_.size();
  if (of_.empty()) AddNearest(swarm);
  for (std::size_t i = 0; i < chosen_.size(); ++i) {
    const T present = (*swarm.field)[i].present;
    const auto changed = (chosen_[i] >= zero) && !(chosen_[i] == f.target[i]);
    switches_ += Select(changed && (present > T(0.5)), one, zero);
    chosen_[i] = f.target[i];
    if (!of_.empty()) AddSwaps(swarm, i);
    judged_ += present;
    for (int lane = 0; lane < kLanesOf<T>; ++lane) {
      if (Lane(present, lane) < 0.5) continue;
      std::array<Vec3<double>, agent::kMostTargets> believed, truth;
      int known = 0;
      for (std::size_t t = 0; t < n; ++t) {
        truth[t] = Lane(swarm.targets[t].p_WT, lane);
        if (Lane(f.known[i * n + t], lane) < 0.5) continue;
        believed[static_cast<std::size_t>(known++)] = Lane(f.p_WT[i * n + t], lane);
      }
      const SetDistance d =
          DistanceOfSets(believed.data(), known, truth.data(), static_cast<int>(n), kCutoff_m);
      SetLane(&ospa_, lane, Lane(ospa_, lane) + d.ospa_m);
      SetLane(&gospa_, lane, Lane(gospa_, lane) + d.gospa_m);
    }
  }
}

template <class T>
void SearchTotals<T>::Add(const SwarmState<T>& swarm, const std::vector<Tracking<T>>& tracking) {
  const T zero(0.0), one(1.0);
  decisions_ += one;
  T outside = zero;
  for (const Tracking<T>& k : tracking) outside += one - InBand(k);
  gathered_ = Select((gathered_ < zero) && (outside < T(0.5)), decisions_, gathered_);
  const T elapsed_s = decisions_ * T(scenario_.run.decision_dt_s());
  if (swarm.following != nullptr) AddChoices(swarm);
  for (std::size_t t = 0; t < targets_.size(); ++t) {
    OfTarget& target = targets_[t];
    T c2 = zero, s2 = zero, near = zero, best = T(1e9), seen = zero, team = zero;
    for (std::size_t i = 0; i < tracking.size(); ++i) {
      if (swarm.following == nullptr && i % targets_.size() != t) continue;
      const T follows = swarm.follows(i, t);
      const auto ours = follows > T(0.5);
      const FieldState<T>& f = (*swarm.field)[i];
      const Vec3<T>& r = tracking[i].r_BT_W;
      const T square = Max(r.x * r.x + r.y * r.y, T(1e-6));
      c2 += follows * ((r.x * r.x - r.y * r.y) / square);
      s2 += follows * (T(2.0) * r.x * r.y / square);
      near += follows * InBand(tracking[i]);
      best = Min(best, Select((f.known > T(0.5)) && ours, Level(f.r_BT_W - r), T(1e9)));
      // The cue is from the start, so only an observation is younger than the episode.
      const auto observed = (f.known > T(0.5)) && (f.age_s < elapsed_s - T(1e-3));
      seen = Select(observed && ours, one, seen);
      team += follows;
    }
    target.detected =
        Select((target.detected < zero) && (seen > T(0.5)), decisions_, target.detected);
    const auto followed = (near > T(target.wanted - 0.5)) && (best < T(kGood_m));
    target.followed += Select(followed, one, zero);
    info_spread_ +=
        (one - Sqrt(c2 * c2 + s2 * s2) / Max(team, one)) / T(static_cast<double>(targets_.size()));
    Follow(swarm.targets[t].p_WT, &target);
  }
}

template <class T>
SearchMetrics SearchTotals<T>::Metrics(int lane, double steps) const {
  const double dt_s = scenario_.run.decision_dt_s(), length_s = steps * dt_s;
  const double count = static_cast<double>(targets_.size());
  SearchMetrics m;
  m.found = m.worst_followed = 1.0;
  double way = 0.0, net = 0.0;
  for (const OfTarget& t : targets_) {
    const double detected = Lane(t.detected, lane), followed = Lane(t.followed, lane) / steps;
    m.found = std::min(m.found, detected < 0.0 ? 0.0 : 1.0);
    m.time_to_detect += (detected < 0.0 ? length_s : detected * dt_s) / count;
    m.followed += followed / count;
    m.worst_followed = std::min(m.worst_followed, followed);
    way += Lane(t.way, lane);
    net += Lane(t.net, lane);
  }
  const double gathered = Lane(gathered_, lane);
  m.time_to_gather = gathered < 0.0 ? length_s : gathered * dt_s;
  m.info_spread = Lane(info_spread_, lane) / steps;
  m.target_net_speed = way > 0.0 ? net / way : 0.0;
  if (scenario_.agent.task.free()) {
    const double judged = std::max(1.0, Lane(judged_, lane));
    m.choices = ChoiceMetrics{Lane(switches_, lane) / static_cast<double>(chosen_.size()),
                              Lane(ospa_, lane) / judged,
                              Lane(gospa_, lane) / judged,
                              {},
                              {}};
    if (of_.empty()) {
      m.choices->nearest_error = Lane(nearest_, lane) / std::max(1.0, Lane(nearest_known_, lane));
    } else {
      m.choices->swaps = Lane(swaps_, lane) / static_cast<double>(chosen_.size());
    }
  }
  return m;
}

template class SearchTotals<double>;
template class SearchTotals<Pack>;

}  // namespace stg::task
