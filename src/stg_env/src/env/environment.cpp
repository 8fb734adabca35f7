#include "environment.hpp"

#include <cassert>

#include "auv_dynamics/control/control.hpp"
#include "scatter.hpp"
#include "sources/acoustic_source.hpp"
#include "sources/truth_source.hpp"

namespace stg::env {
namespace {

std::unique_ptr<InformationSource> MakeSource(InformationMode mode, const agent::AgentModel& model,
                                              const dynamics::WorldConfig& world,
                                              const acoustics::ChannelConfig& channel) {
  if (mode == InformationMode::kTruth) {
    return std::make_unique<TruthSource>(model, channel.range_m);
  }
  const auto shadows = dynamics::ShadowsOf(world.sea, world.workspace.half_extent_m);
  return std::make_unique<AcousticSource>(model, channel, world.sensing, shadows);
}

}  // namespace

Environment::Environment(const Scenario& scenario)
    : scenario_(scenario),
      model_(scenario.model()),
      world_(scenario.world, scenario.run, model_.navigation),
      source_(MakeSource(scenario.mode, model_, scenario.world, scenario.channel)),
      task_(scenario.judge()),
      observation_size_(model_.observation_size()) {
  task::Effort<Pack> zero;
  zero.fill(Pack(0.0));
  for (std::size_t k = 0; k < share_.size(); ++k) {
    share_[k] = model_.vehicle.max_tau[k] / scenario.world.vehicle.max_tau[k];
  }
  tau_.assign(static_cast<std::size_t>(scenario.run.agents), zero);
  action_ = tau_;
  wrench_.resize(tau_.size());
  if (scenario.world.sea.open) field_.resize(tau_.size());
  if (scenario.agent.task.free()) {
    following_ =
        std::make_unique<task::Following<Pack>>(scenario.run.agents, scenario.world.target.count);
  }
  if (dynamics::Helm::Steers(scenario.world.vehicle)) {
    helm_ = std::make_unique<dynamics::Helm>(scenario.world.vehicle, model_.vehicle,
                                             model_.control.autopilot, scenario.run);
    v_des_W_.resize(tau_.size());
  }
}

Environment::~Environment() = default;
Environment::Environment(Environment&&) noexcept = default;

AcousticSource& Environment::acoustic() const {
  assert(scenario_.mode == InformationMode::kAcoustic);
  return static_cast<AcousticSource&>(*source_);
}

void Environment::Zero(int lane, int episode_steps) {
  SetLane(&length_, lane, static_cast<double>(episode_steps));
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    for (Pack& x : tau_[i]) SetLane(&x, lane, 0.0);
    for (Pack& x : action_[i]) SetLane(&x, lane, 0.0);
  }
  if (helm_ != nullptr) helm_->Reset(lane);
}

void Environment::Reset(int lane, std::uint64_t seed, dynamics::ResetStage stage,
                        int episode_steps) {
  world_.Reset(lane, seed, 0, stage);
  Zero(lane, episode_steps);
}

void Environment::Place(int lane, const std::vector<Vec3<double>>& p_WB,
                        const std::vector<Vec3<double>>& p_WT,
                        const std::vector<Vec3<double>>& v_WT) {
  world_.Place(lane, p_WB, p_WT, v_WT);
  Zero(lane, scenario_.run.time.episode_steps);
}

void Environment::Begin(const LaneSet& lanes) {
  source_->Start(world_, lanes);
  source_->Observe(world_, lanes);
  LookAround();
  task_.Start(lanes.mask(), Swarm(), length_);
}

void Environment::Move(const Pack* wanted) {
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    source_->Act(world_, static_cast<int>(i), wanted, &action_[i], &tau_[i]);
    const auto wrench = dynamics::ScaleWrench(model_.vehicle, tau_[i].data());
    wrench_[i].force = wrench.force;  // in two parts, because copying the whole struct is a call
    wrench_[i].moment = wrench.moment;
    for (std::size_t k = 0; k < share_.size(); ++k) tau_[i][k] = tau_[i][k] * Pack(share_[k]);
    wanted += scenario_.world.control.action_size();
  }
  source_->Send(world_);
  if (helm_ != nullptr) {
    Steer();
  } else {
    for (int k = 0; k < scenario_.run.time.decision_steps; ++k) world_.Step(wrench_);
  }
  world_.CheckFinite();
}

void Environment::Steer() {
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    v_des_W_[i] = dynamics::DesiredVelocity(model_.vehicle, action_[i].data());
  }
  helm_->Drive(v_des_W_, &world_);
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    tau_[i].fill(Pack(0.0));
    helm_->WriteShares(static_cast<int>(i), tau_[i].data());
  }
}

void Environment::Judge() {
  source_->Observe(world_, LaneSet::All());
  LookAround();
  // The rewarded link quality is the quality after the step.
  if (scenario_.reward.kind == task::RewardKind::kPaper) {
    link_quality_ = source_->LinkQuality(world_);
  }
  task_.Step(Swarm());
}

void Environment::AskWhatTheyFollow() {
  if (following_ == nullptr) return;
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    source_->Choose(static_cast<int>(i), following_.get());
    if (!scenario_.world.sensing.labelled) following_->Match(i, world_.target_states());
    for (int lane = 0; lane < kLanes; ++lane) {
      const dynamics::TargetState<Pack>& target =
          world_.target(followed(lane, static_cast<int>(i)));
      SetLane(&following_->state[i].p_WT, lane, Lane(target.p_WT, lane));
      SetLane(&following_->state[i].v_WT, lane, Lane(target.v_WT, lane));
    }
  }
}

/// Updates the AUVs' places in open water and their beliefs.
void Environment::LookAround() {
  AskWhatTheyFollow();
  const dynamics::Sea& sea = world_.sea();
  for (std::size_t i = 0; i < field_.size(); ++i) {
    const int id = static_cast<int>(i);
    task::FieldState<Pack>& f = field_[i];
    source_->Tell(world_, id, &f);
    f.groundings = sea.groundings(id);
    f.collisions = sea.collisions(id);
    const Vec3<Pack>& p_WB = world_.vehicle(id).p_WB;
    for (int lane = 0; lane < kLanes; ++lane) {
      const Vec3<double> p = Lane(p_WB, lane);
      SetLane(&f.altitude_m, lane, sea.scape().Altitude(p));
      SetLane(&f.clearance_m, lane, sea.scape().Clearance(p));
    }
  }
}

agent::Knowledge<Pack> Environment::Truth(int i) const {
  agent::Knowledge<Pack> k;
  k.SetNavigation(world_.vehicle(i));
  static_cast<agent::Tracking<Pack>&>(k) = task_.tracking(i);
  k.v_WT = Swarm().target_of(static_cast<std::size_t>(i)).v_WT;
  return k;
}

task::SwarmState<Pack> Environment::Swarm() const {
  return {world_.vehicle_states(),
          world_.target_states(),
          world_.separations(),
          tau_,
          action_,
          link_quality_,
          field_.empty() ? nullptr : &field_,
          following_.get()};
}

void Environment::WriteObservations(int lanes, float* rows) const {
  const auto size = static_cast<std::size_t>(observation_size_);
  const std::size_t stride = tau_.size() * size;
  Pack columns[agent::kMaxObservationSize];
  for (std::size_t i = 0; i < tau_.size(); ++i) {
    agent::BuildObservation(model_, source_->knowledge(static_cast<int>(i)),
                            [&](int index, const Pack& value) { columns[index] = value; });
    Scatter(columns, static_cast<int>(size), lanes, rows + i * size, stride);
  }
}

void Environment::WriteStates(int lanes, float* rows) const {
  const auto stride =
      static_cast<std::size_t>(task::CriticStateSize(scenario_.run, scenario_.world));
  task_.WriteCriticState(Swarm(), [&](const Pack* numbers, int count) {
    Scatter(numbers, count, lanes, rows, stride);
    rows += count;
  });
}

void Environment::WriteRewards(int lanes, float* rows) const {
  const auto stride = tau_.size();
  for (std::size_t i = 0; i < stride; ++i) {
    Scatter(&task_.terms(static_cast<int>(i)).total, 1, lanes, rows + i, stride);
  }
}

}  // namespace stg::env
