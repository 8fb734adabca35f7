#include "stg_agent/entities/entity_pilot.hpp"

#include <algorithm>
#include <cmath>

#include "stg_agent/controllers/assign.hpp"
#include "stg_agent/controllers/search_laws.hpp"

namespace stg::agent {
namespace {

// If the commanded radius is larger than the law's, the deviation of the estimate is added. So a
// lost target is searched on circles as wide as the uncertainty.
constexpr double kRadius_m = 60.0, kDoubts = 3.0, kWidest_m = 800.0;
constexpr double kSpeed_mps = 0.8, kPhase_rad = kPi / 3.0, kDepth_m = 15.0;
constexpr double kTurn_rad = kPi / 3.0;
constexpr float kClockwiseFrom = -0.8F;
// Share of the largest velocity that a command of `velocity3` reaches: that of `medium`.
constexpr double kShare = 0.75;
// A command is the tanh of a network's output, which does not reach 1.
constexpr double kMostTaught = 0.98;

/// Acts by Encircle with the neighbours that built-in laws use. In a current the AUV flies fast
/// enough to stay on its circle (chosen on seeds from 901,000).
void Steer(const AgentView& agent, const Guidance<double>& guidance, double* action) {
  static const Encircle law = [] {
    EncircleOptions o;
    o.slow_in_current = 1.0;
    return Encircle{o};
  }();
  const NearestSights nearest = agent.Nearest();
  law.Act(InputOf(agent, nearest), guidance, action);
}

/// The law that `law5` guides. With a search map it is `search_map`; without one it is the part of
/// that law for a target that is found. A target that may be faster than the AUVs' cruise speed
/// would leave a circle, so AUVs then keep a place relative to it.
void SteerLaw(const AgentView& agent, const Guidance<double>& guidance, double* action) {
  static const std::unique_ptr<SearchLaw> searching = MakeSearchMap({});
  if (agent.search() != nullptr) {
    searching->Act(agent, guidance, agent.memory().search, action);
  } else if (TooFastToCircle(agent.model())) {
    const NearestSights nearest = agent.Nearest();
    Formation{}.Act(InputOf(agent, nearest), guidance, action);
  } else {
    Steer(agent, guidance, action);
  }
}

/// Standard deviation of the target's position along the long axis of its horizontal ellipse [m].
double LevelDeviation(const AgentView& agent) {
  const Covariance3 P = agent.belief().P_WT;
  const double mean = 0.5 * (P.xx + P.yy), half = 0.5 * (P.xx - P.yy);
  return std::sqrt(std::max(mean + std::hypot(half, P.xy), 0.0));
}

/// Velocity of a command of `course3`: a change of the present course, a speed over ground and a
/// climb rate. Zeros keep the course at the middle speed.
Vec3<double> VelocityOf(const AgentView& agent, const float* command) {
  const Knowledge<double>& k = agent.knowledge();
  const double most = agent.model().vehicle.max_velocity_mps[0];
  const double least = std::min(most, agent.model().control.autopilot.min_speed_mps);
  const bool moves = std::hypot(k.v_WB.x, k.v_WB.y) >= 0.3;
  const double course =
      moves ? std::atan2(k.v_WB.y, k.v_WB.x) : std::atan2(k.trig.sin_psi, k.trig.cos_psi);
  const double to = course + kTurn_rad * static_cast<double>(command[0]);
  const double speed = least + (most - least) * 0.5 * (1.0 + static_cast<double>(command[1]));
  const double climb = agent.model().vehicle.max_velocity_mps[2] * static_cast<double>(command[2]);
  return {speed * std::cos(to), speed * std::sin(to), climb};
}

/// Velocity of a command of `velocity3` in world axes, as a share of the largest velocity. The
/// command is ahead, to port and up, because the limits belong to the axes of the vehicle.
void HeadingVelocity(const AgentView& agent, const float* command, double* velocity) {
  const auto& most = agent.model().vehicle.max_velocity_mps;
  const EulerTrig<double>& trig = agent.knowledge().trig;
  const double ahead = kShare * most[0] * static_cast<double>(command[0]);
  const double aport = kShare * most[1] * static_cast<double>(command[1]);
  const double x = trig.cos_psi * ahead - trig.sin_psi * aport;
  const double y = trig.sin_psi * ahead + trig.cos_psi * aport;
  velocity[0] = std::clamp(x / most[0], -1.0, 1.0);
  velocity[1] = std::clamp(y / most[1], -1.0, 1.0);
  velocity[2] = kShare * static_cast<double>(command[2]);
}

}  // namespace

Guidance<double> GuidanceOf(const float* command, double doubt_m) {
  Guidance<double> g;
  const auto wider = static_cast<double>(command[0]);
  g.radius_m = kRadius_m * wider;
  if (wider > 0.0) g.radius_m += wider * std::min(kDoubts * doubt_m, kWidest_m);
  g.speed_mps = kSpeed_mps * static_cast<double>(command[1]);
  g.phase_rad = kPhase_rad * static_cast<double>(command[2]);
  g.sense = command[3] <= kClockwiseFrom ? -1.0 : 1.0;
  g.depth_m = kDepth_m * static_cast<double>(command[4]);
  return g;
}

int DecisionsPerCommand(const RunConfig& run) {
  return std::max(1, static_cast<int>(std::lround(kCommandPeriod_s / run.decision_dt_s())));
}

double CommandPeriod_s(const RunConfig& run) {
  return DecisionsPerCommand(run) * run.decision_dt_s();
}

int DecisionsPerCommand(const RunConfig& run, EntityAction action) {
  return action == EntityAction::kVelocity3 ? 1 : DecisionsPerCommand(run);
}

double CommandPeriod_s(const RunConfig& run, EntityAction action) {
  return DecisionsPerCommand(run, action) * run.decision_dt_s();
}

bool CommandDue(const EntityMemory& memory, EntityAction action) {
  return !memory.commanded || action == EntityAction::kVelocity3 ||
         Seconds(memory.now - memory.command_time) >= kCommandPeriod_s - 1e-6;
}

void TakeCommand(const AgentView& agent, EntityAction action, const float* command) {
  EntityMemory& memory = agent.memory();
  memory.commanded = true;
  memory.command_time = memory.now;
  memory.command.fill(0.0F);
  for (int k = 0; k < CommandSize(action); ++k) {
    memory.command[static_cast<std::size_t>(k)] = std::clamp(command[k], -1.0F, 1.0F);
  }
  if (action == EntityAction::kCourse3) {
    memory.velocity_W = VelocityOf(agent, memory.command.data());
  }
}

void TakeChoice(const AgentView& agent, const Entities& entities, int choice) {
  // Without a target, the law searches for one by itself and follows it when it is found.
  agent.memory().search = entities.targets > 0 && choice == entities.targets;
  if (choice < entities.targets) agent.Follow(entities.target_of_row[choice]);
}

void TakeDecision(const AgentView& agent, const Entities& entities, EntityAction action,
                  bool chooses, int choice, const float* command) {
  static const Assign law{AssignOptions{}};
  TakeCommand(agent, action, command);
  if (chooses) {
    TakeChoice(agent, entities, choice);
  } else {
    law.ChooseWhenDue(agent);
  }
}

void VelocityCommandOf(const AgentView& agent, const double* velocity, float* command) {
  const auto& most = agent.model().vehicle.max_velocity_mps;
  const EulerTrig<double>& trig = agent.knowledge().trig;
  const double x = velocity[0] * most[0], y = velocity[1] * most[1];
  const double wanted[3] = {(trig.cos_psi * x + trig.sin_psi * y) / (kShare * most[0]),
                            (trig.cos_psi * y - trig.sin_psi * x) / (kShare * most[1]),
                            velocity[2] / kShare};
  for (int a = 0; a < 3; ++a) {
    command[a] = static_cast<float>(std::clamp(wanted[a], -kMostTaught, kMostTaught));
  }
}

void FollowCommand(const AgentView& agent, EntityAction action, float* out) {
  const AgentModel& model = agent.model();
  const EntityMemory& memory = agent.memory();
  double wanted[dynamics::kMaxActionSize];
  if (action == EntityAction::kVelocity3) {
    double velocity[3];
    HeadingVelocity(agent, memory.command.data(), velocity);
    AskForVelocity(ControllerInput<double>{model, agent.id(), agent.knowledge(), nullptr, 0},
                   velocity, wanted);
  } else if (action != EntityAction::kCourse3) {
    const Guidance<double> guidance = GuidanceOf(memory.command.data(), LevelDeviation(agent));
    (action == EntityAction::kLaw5 ? SteerLaw : Steer)(agent, guidance, wanted);
  } else {
    const auto& most = model.vehicle.max_velocity_mps;
    const Vec3<double>& v = memory.velocity_W;
    const double velocity[3] = {std::clamp(v.x / most[0], -1.0, 1.0),
                                std::clamp(v.y / most[1], -1.0, 1.0),
                                std::clamp(v.z / most[2], -1.0, 1.0)};
    AskForVelocity(ControllerInput<double>{model, agent.id(), agent.knowledge(), nullptr, 0},
                   velocity, wanted);
  }
  for (int k = 0; k < model.control.action_size(); ++k) out[k] = static_cast<float>(wanted[k]);
}

void Fly(const EntityPolicy& policy, const AgentView& agent, float* out) {
  if (CommandDue(agent.memory(), policy.action())) {
    Entities entities;
    BuildEntities(agent, &entities);
    float command[kCommandNumbers];
    const int choice = policy.Command(entities, command);
    TakeDecision(agent, entities, policy.action(), policy.chooses(), choice, command);
  }
  FollowCommand(agent, policy.action(), out);
}

}  // namespace stg::agent
