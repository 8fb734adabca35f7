#include "truth_source.hpp"

#include <algorithm>

#include "acoustic_channel/link/link_quality.hpp"
#include "auv_dynamics/control/control.hpp"

namespace stg::env {

TruthSource::TruthSource(const Scenario& scenario)
    : scenario_(scenario),
      truth_(static_cast<size_t>(scenario.agents)),
      error_window_(
          truth_.size(),
          std::vector<Pack>(static_cast<size_t>(scenario.observation.error_window), Pack(0.0))) {}

void TruthSource::Start(const dynamics::World&, const LaneSet&) {
  for (auto& k : truth_) {
    for (Pack& t : k.tau) t = Pack(0.0);
    k.lost_steps = Pack(0.0);
  }
  step_ = 0;
  first_ = true;
}

void TruthSource::Observe(const dynamics::World& world, const LaneSet&) {
  if (!first_) ++step_;
  Measure(world, first_);
  first_ = false;
}

void TruthSource::Act(const dynamics::World& world, int i, const Pack* a,
                      std::array<Pack, 6>* action, std::array<Pack, 6>* tau) {
  auto& executed = *action;
  if (scenario_.control.interface == dynamics::ActionInterface::kTau6) {
    // Rate limit and smoothing belong to the velocity interface.
    for (int k = 0; k < 6; ++k) executed[static_cast<size_t>(k)] = Clip(a[k], -1.0, 1.0);
    *tau = executed;
  } else {
    dynamics::SmoothAction(scenario_.control, scenario_.action_size(), a, executed.data());
    const dynamics::VehicleState<Pack>& s = world.vehicle(i);
    Vec3<Pack> rpy = s.rpy;
    if (scenario_.vehicle.integrator == dynamics::Integrator::kRk4) rpy = RpyOf(s.trig);
    dynamics::VelocityController(scenario_.control, scenario_.vehicle,
                                 dynamics::DesiredVelocity(scenario_.vehicle, executed.data()),
                                 s.R_WB, s.v_WB, rpy, s.w_WB_B, tau->data());
  }
  std::copy(tau->begin(), tau->end(), truth_[static_cast<size_t>(i)].tau);
}

void TruthSource::Measure(const dynamics::World& world, bool first) {
  const agent::ObservationConfig& c = scenario_.observation;
  const int n = scenario_.agents;
  const Pack zero(0.0), one(1.0);
  for (int i = 0; i < n; ++i) {
    const auto ui = static_cast<size_t>(i);
    const dynamics::VehicleState<Pack>& s = world.vehicle(i);
    const dynamics::TargetState<Pack>& t = world.target(scenario_.target_of(i));
    agent::Knowledge<Pack>& k = truth_[ui];
    k.p_WB = s.p_WB;
    k.v_WB = s.v_WB;
    k.v_WB_B = s.v_WB_B;
    k.w_WB_B = s.w_WB_B;
    k.R_WB = s.R_WB;
    k.trig = s.trig;
    k.r_BT_W = t.p_WT - s.p_WB;
    k.v_WT = t.v_WT;
    const Pack d = Norm(k.r_BT_W);
    k.previous_distance = first ? d : k.distance;
    k.distance = d;
    k.error = Abs(d - Pack(scenario_.task.desired_distance_m));
    k.mean_error = MeanError(ui, k.error);
    k.closing = agent::ClosingSpeed(k.r_BT_W, d, k.v_WB, k.v_WT);
    k.confidence = agent::Confidence(d, scenario_.sensing.range_m);
    k.lost = Select(d > Pack(scenario_.task.lost_distance_m), one, zero);
    Pack lost_steps = k.lost_steps + one;
    // The release counts a lost decision in the reward and once more for show.
    if (c.release_bookkeeping && !first) lost_steps = Max(lost_steps, Pack(2.0));
    k.lost_steps = lost_steps * k.lost;
  }
  Pack total_error = zero, nearest(1e9);
  for (const auto& k : truth_) {
    total_error += k.error;
    nearest = Min(nearest, k.distance);
  }
  const Pack others(1.0 / std::max(1, n - 1)), available(c.link_available);
  for (int i = 0; i < n; ++i) {
    agent::Knowledge<Pack>& k = truth_[static_cast<size_t>(i)];
    Pack mean = zero, best = zero, effective = zero;
    for (int j = 0; j < n; ++j) {
      if (j == i) continue;
      const Pack q = acoustics::RangeQuality(world.distance(i, j), scenario_.channel.range_m);
      mean += q;
      best = Max(best, q);
      effective += Select(q > available, one, zero);
    }
    k.effective_fraction = effective * others;
    k.mean_quality = mean * others;
    k.best_quality = best;
    k.mean_neighbour_error = n > 1 ? (total_error - k.error) * others : k.error;
    k.closest = Select(k.distance <= nearest, one, zero);
    NeighbourFeatures(world, i, &k);
  }
}

Pack TruthSource::MeanError(size_t i, const Pack& error) {
  auto& window = error_window_[i];
  const int k = static_cast<int>(window.size());
  const auto at = [&](int step) -> Pack& { return window[static_cast<size_t>(step % k)]; };
  at(step_) = error;
  Pack sum(0.0);
  int count = 0;
  if (scenario_.observation.release_bookkeeping) {
    // History from the first step on, at most k - 1 of it, and the current error again.
    for (int step = std::max(1, step_ - k + 2); step <= step_; ++step, ++count) sum += at(step);
    sum += error;
    ++count;
  } else {
    for (int step = std::max(0, step_ - k + 1); step <= step_; ++step, ++count) sum += at(step);
  }
  return sum * Pack(1.0 / count);
}

void TruthSource::NeighbourFeatures(const dynamics::World& world, int i,
                                    agent::Knowledge<Pack>* k) const {
  const int n = scenario_.agents;
  if (scenario_.observation.order == agent::NeighbourOrder::kIndex) {
    for (int slot = 0, j = 0; slot < agent::kNeighbourSlots && j < n; ++j) {
      if (j == i) continue;
      k->neighbour[slot++] = world.vehicle(j).p_WB - k->p_WB;
    }
    return;
  }
  agent::NearestSlots<Pack> nearest;
  for (int j = 0; j < n; ++j) {
    if (j != i) nearest.Offer(world.vehicle(j).p_WB - k->p_WB, world.distance(i, j));
  }
  std::copy(nearest.offset, nearest.offset + agent::kNeighbourSlots, k->neighbour);
}

Pack TruthSource::LinkQuality(const dynamics::World& world) const {
  // Mean of q (Eq. 5) over the edges that exist.
  const Pack zero(0.0), one(1.0);
  Pack sum = zero, edges = zero;
  for (int i = 0; i < scenario_.agents; ++i) {
    for (int j = i + 1; j < scenario_.agents; ++j) {
      const Pack q = acoustics::RangeQuality(world.distance(i, j), scenario_.channel.range_m);
      sum += q;
      edges += Select(q > zero, one, zero);
    }
  }
  return sum / Max(edges, one);
}

}  // namespace stg::env
