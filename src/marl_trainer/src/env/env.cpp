#include "marl_trainer/env/env.hpp"

#include <cassert>

#include "acoustic_channel/models/range.hpp"
#include "auv_dynamics/control/control.hpp"
#include "env_internal.hpp"

namespace stg::env {

EnvGroup::EnvGroup(const Scenario& scenario, const EnvOptions& options)
    : scenario_(scenario),
      options_(options),
      world_(scenario),
      observation_size_(scenario.observation_size()),
      episode_steps_(scenario.time.episode_steps),
      totals_(std::make_unique<Totals>(scenario)) {
  const auto n = static_cast<size_t>(scenario_.agents);
  truth_.resize(n);
  error_window_.assign(
      n, std::vector<Pack>(static_cast<size_t>(scenario_.observation.error_window), Pack(0.0)));
  std::array<Pack, 6> zero;
  zero.fill(Pack(0.0));
  for (auto* v : {&action_, &previous_action_, &tau_, &previous_tau_}) v->assign(n, zero);
  wrench_.resize(n);
  terms_.resize(n);
  const auto rows = static_cast<size_t>(kLanes) * n;
  observations_.assign(rows * static_cast<size_t>(observation_size_), 0.0F);
  final_observations_ = observations_;
  states_.assign(static_cast<size_t>(kLanes * state_size()), 0.0F);
  final_states_ = states_;
  rewards_.assign(kLanes, 0.0F);
  actions_.assign(rows * static_cast<size_t>(action_size()), 0.0);
  finished_.resize(kLanes);
  if (scenario_.mode == InformationMode::kAcoustic)
    acoustic_ = std::make_unique<Acoustic>(scenario_);
}

EnvGroup::~EnvGroup() = default;
EnvGroup::EnvGroup(EnvGroup&&) noexcept = default;

void EnvGroup::Reset() { RestartAt(0, options_.first_episode_steps); }

void EnvGroup::RestartAt(std::uint64_t round, int first_episode_steps) {
  round_ = round;
  episode_steps_ = first_episode_steps > 0 ? first_episode_steps : scenario_.time.episode_steps;
  truncated_ = false;
  StartEpisode();
}

void EnvGroup::StartEpisode() {
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::uint64_t r = static_cast<std::uint64_t>(options_.first_env + lane) +
                            round_ * static_cast<std::uint64_t>(options_.total_envs);
    dynamics::ResetStage stage = scenario_.reset.stage;
    if (options_.curriculum) {
      const auto& c = scenario_.reset;
      stage = r < static_cast<std::uint64_t>(c.curriculum_easy_resets) ? dynamics::ResetStage::kEasy
              : r < static_cast<std::uint64_t>(c.curriculum_medium_resets)
                  ? dynamics::ResetStage::kMedium
                  : dynamics::ResetStage::kHard;
    }
    world_.Reset(lane, options_.seed + r, 0, stage);
  }
  BeginSemantics();
}

void EnvGroup::Place(const std::vector<Vec3<double>>& p_WB, const std::vector<Vec3<double>>& p_WT,
                     const std::vector<Vec3<double>>& v_WT) {
  for (int lane = 0; lane < kLanes; ++lane) world_.Place(lane, p_WB, p_WT, v_WT);
  episode_steps_ = scenario_.time.episode_steps;
  truncated_ = false;
  BeginSemantics();
}

void EnvGroup::BeginSemantics() {
  step_ = 0;
  for (size_t i = 0; i < truth_.size(); ++i) {
    for (int k = 0; k < 6; ++k) {
      const auto uk = static_cast<size_t>(k);
      action_[i][uk] = previous_action_[i][uk] = tau_[i][uk] = previous_tau_[i][uk] = Pack(0.0);
    }
    truth_[i].lost_steps = Pack(0.0);
  }
  totals_->Clear();
  Measure(true);
  if (acoustic_) {
    acoustic_->Start(world_);
    AcousticObserve();
  }
  WriteObservations();
  WriteStates();
}

void EnvGroup::Step(const float* actions) {
  for (size_t k = 0; k < actions_.size(); ++k) actions_[k] = static_cast<double>(actions[k]);
  Step();
}

void EnvGroup::Step(const double* actions) {
  std::copy(actions, actions + actions_.size(), actions_.begin());
  Step();
}

void EnvGroup::Step() {
  const auto n = static_cast<size_t>(scenario_.agents);
  for (size_t i = 0; i < n; ++i) {
    previous_action_[i] = action_[i];
    previous_tau_[i] = tau_[i];
  }
  if (acoustic_) {
    AcousticActions();
  } else {
    TruthActions();
  }
  for (size_t i = 0; i < n; ++i)
    wrench_[i] = dynamics::ScaleWrench(scenario_.vehicle, tau_[i].data());
  for (int k = 0; k < scenario_.time.decision_steps; ++k) world_.Step(wrench_);
  ++step_;
  Measure(false);
  if (acoustic_) AcousticObserve();  // before the reward: the agents' link quality is in it
  ComputeRewards();
  WriteObservations();
  WriteStates();
  truncated_ = step_ >= episode_steps_;
  if (truncated_) FinishEpisode();
}

void EnvGroup::TruthActions() {
  const int size = action_size();
  const int n = agents();
  for (int i = 0; i < n; ++i) {
    Pack a[6];
    for (int k = 0; k < size; ++k) {
      alignas(64) double buffer[kLanes];
      for (int lane = 0; lane < kLanes; ++lane) {
        const double value = actions_[static_cast<size_t>((lane * n + i) * size + k)];
        assert(std::isfinite(value));
        buffer[lane] = value;
      }
      a[k] = Pack::load_aligned(buffer);
    }
    auto& executed = action_[static_cast<size_t>(i)];
    auto& tau = tau_[static_cast<size_t>(i)];
    if (scenario_.control.interface == dynamics::ActionInterface::kTau6) {
      // Rate limit and smoothing belong to the velocity interface.
      for (int k = 0; k < 6; ++k) executed[static_cast<size_t>(k)] = Clip(a[k], -1.0, 1.0);
      tau = executed;
      continue;
    }
    dynamics::SmoothAction(scenario_.control, size, a, executed.data());
    const dynamics::VehicleState<Pack>& s = world_.vehicle(i);
    Vec3<Pack> rpy = s.rpy;
    if (scenario_.vehicle.integrator == dynamics::Integrator::kRk4) rpy = RpyOf(s.trig);
    dynamics::VelocityController(scenario_.control, scenario_.vehicle,
                                 dynamics::DesiredVelocity(scenario_.vehicle, executed.data()),
                                 s.R_WB, s.v_WB, rpy, s.w_WB_B, tau.data());
  }
}

void EnvGroup::Measure(bool first) {
  const agent::ObservationConfig& c = scenario_.observation;
  const int n = agents();
  const Pack zero(0.0), one(1.0);
  for (int i = 0; i < n; ++i) {
    const auto ui = static_cast<size_t>(i);
    const dynamics::VehicleState<Pack>& s = world_.vehicle(i);
    const dynamics::TargetState<Pack>& t = world_.target(scenario_.target_of(i));
    agent::Knowledge<Pack>& k = truth_[ui];
    k.p_WB = s.p_WB;
    k.v_WB = s.v_WB;
    k.v_WB_B = s.v_WB_B;
    k.w_WB_B = s.w_WB_B;
    k.R_WB = s.R_WB;
    k.trig = s.trig;
    k.r_BT_W = t.p_WT - s.p_WB;
    k.v_WT = t.v_WT;
    for (size_t a = 0; a < 6; ++a) k.tau[a] = tau_[ui][a];
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
  if (acoustic_) return;  // agents build their own neighbour features
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
      const Pack q = acoustics::RangeQuality(world_.distance(i, j), scenario_.channel.range_m);
      mean += q;
      best = Max(best, q);
      effective += Select(q > available, one, zero);
    }
    k.effective_fraction = effective * others;
    k.mean_quality = mean * others;
    k.best_quality = best;
    k.mean_neighbour_error = n > 1 ? (total_error - k.error) * others : k.error;
    k.closest = Select(k.distance <= nearest, one, zero);
    NeighbourFeatures(i, &k);
  }
}

Pack EnvGroup::MeanError(size_t i, const Pack& error) {
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

void EnvGroup::NeighbourFeatures(int i, agent::Knowledge<Pack>* k) const {
  const int n = agents();
  if (scenario_.observation.order == agent::NeighbourOrder::kIndex) {
    for (int slot = 0, j = 0; slot < agent::kNeighbourSlots && j < n; ++j) {
      if (j == i) continue;
      k->neighbour[slot++] = world_.vehicle(j).p_WB - k->p_WB;
    }
    return;
  }
  agent::NearestSlots<Pack> nearest;
  for (int j = 0; j < n; ++j) {
    if (j != i) nearest.Offer(world_.vehicle(j).p_WB - k->p_WB, world_.distance(i, j));
  }
  std::copy(nearest.offset, nearest.offset + agent::kNeighbourSlots, k->neighbour);
}

void EnvGroup::ComputeRewards() {
  const int n = agents();
  const task::RewardConfig& c = scenario_.reward;
  const bool raw = c.kind == task::RewardKind::kReleaseRaw;
  const Pack inv_n(1.0 / n), zero(0.0), one(1.0);
  Pack deviation = zero;
  for (const auto& k : truth_) deviation += raw ? k.error : task::BandDeviation(c, k.distance);
  deviation = deviation * inv_n;
  const Pack coordination = task::CoordinationReward(c, deviation);
  Pack communication = zero;
  if (c.kind != task::RewardKind::kPaper) {
    communication = task::ReleaseCommunication(deviation, scenario_.sensing.range_m);
  } else if (acoustic_) {
    communication = acoustic_->MeanLinkQuality();
  } else if (followed_quality_) {
    communication = *followed_quality_;
  } else {
    // Eq. 33: mean of q (Eq. 5) over the edges that exist.
    Pack edges = zero;
    for (int i = 0; i < n; ++i) {
      for (int j = i + 1; j < n; ++j) {
        const Pack q = acoustics::RangeQuality(world_.distance(i, j), scenario_.channel.range_m);
        communication += q;
        edges += Select(q > zero, one, zero);
      }
    }
    communication = communication / Max(edges, one);
  }
  Pack team = zero;
  const bool crowding = c.weights.separation != 0.0;
  for (int i = 0; i < n; ++i) {
    const auto ui = static_cast<size_t>(i);
    const agent::Knowledge<Pack>& k = truth_[ui];
    task::RewardInput<Pack> in;
    in.distance = k.distance;
    const bool unknown = scenario_.observation.release_bookkeeping && step_ == 1;
    in.previous_distance = unknown ? k.distance : k.previous_distance;
    in.closing = k.closing;
    in.confidence = k.confidence;
    in.lost = k.lost;
    for (int j = 0; crowding && j < n; ++j) {
      if (j != i) in.crowding += task::SeparationPenalty(c, world_.distance(i, j));
    }
    for (size_t a = 0; a < 6; ++a) {
      in.tau[a] = tau_[ui][a];
      in.previous_tau[a] = previous_tau_[ui][a];
      in.action[a] = action_[ui][a];
      in.previous_action[a] = previous_action_[ui][a];
    }
    terms_[ui] = task::Reward(scenario_, in, coordination, communication);
    team += terms_[ui].total;
  }
  const Pack mean = team * inv_n;
  for (int lane = 0; lane < kLanes; ++lane) {
    rewards_[static_cast<size_t>(lane)] = static_cast<float>(Lane(mean, lane));
  }
  totals_->Add(*this, step_ > episode_steps_ - scenario_.time.tail_steps);
}

void EnvGroup::FinishEpisode() {
  for (int lane = 0; lane < kLanes; ++lane) {
    finished_[static_cast<size_t>(lane)] = totals_->Metrics(lane);
  }
  final_observations_ = observations_;
  final_states_ = states_;
  ++round_;
  episode_steps_ = scenario_.time.episode_steps;
  StartEpisode();
}

}  // namespace stg::env
