#include "stg_agent/controllers/assign.hpp"

#include <algorithm>
#include <cmath>

#include "acoustic_channel/access/medium_access.hpp"
#include "auv_common/numbers/assignment.hpp"

namespace stg::agent {
namespace {

using config::NonNegative;

constexpr int kMostSwarm = 32;  ///< most AUVs that are used: the own one first, then by index
constexpr int kMostPlaces = 96;
/// Cost of each missing AUV, if a target has fewer than `least`.
constexpr double kUnmanned_s = 1e6;
constexpr double kLeastLead_mps = 0.3;

/// An AUV, as input of the assignment.
struct Member {
  Vec3<double> p_W;
  int follows;  ///< -1: unknown
};

/// The known AUVs of the swarm, the own one first.
int Muster(const AgentView& agent, double silent_frames, Member* members) {
  const AgentModel& model = agent.model();
  // Without turns, e.g. with `csma`, the looks of the sensor are the measure.
  const double frame_s = acoustics::RoundOfKeys(model.channel, model.run.agents);
  const double silent_s = silent_frames * std::max(frame_s, model.look_period_s());
  int count = 0;
  members[count++] = {agent.knowledge().p_WB, agent.target()};
  for (const int id : agent.neighbours().known()) {
    const NeighbourSight<double> sight = agent.sight(id);
    if (sight.age_s > silent_s || count == kMostSwarm) continue;
    members[count++] = {sight.p_WN, agent.neighbours().state(id).followed};
  }
  return count;
}

EncircleOptions CircleOf(const AssignOptions& o) {
  EncircleOptions circle;
  circle.fast_mps = o.fast_mps;
  return circle;
}

FormationOptions FormOf(const AssignOptions& o) {
  FormationOptions form;
  form.fast_mps = o.fast_mps;
  return form;
}

}  // namespace

Assign::Assign(const AssignOptions& options)
    : o_(options), circle_{CircleOf(options)}, form_{FormOf(options)} {}

template <class T>
void Assign::Follow(const ControllerInput<T>& in, T* action) const {
  if (o_.form > 0.5) {
    form_.Act(in, {}, action);
  } else {
    circle_.Act(in, {}, action);
  }
}

void Assign::Act(const ControllerInput<double>& in, double* action) const { Follow(in, action); }
void Assign::Act(const ControllerInput<Pack>& in, Pack* action) const { Follow(in, action); }

void Assign::Act(const AgentView& agent, float* action) const {
  ChooseWhenDue(agent);
  Controller::Act(agent, action);
}

void Assign::ChooseWhenDue(const AgentView& agent) const {
  EntityMemory& memory = agent.memory();
  const auto since_s = [&](TimeNs t) { return Seconds(memory.now - t); };
  const bool due = !memory.assigned || since_s(memory.assigned_time) >= o_.period_s - 1e-6;
  if (agent.beliefs() < 2 || !due) return;
  const bool settled = memory.assigned && since_s(memory.followed_since) < o_.hysteresis_s;
  if (!settled) agent.Follow(Choose(agent));
  memory.assigned = true;
  memory.assigned_time = memory.now;
}

int Assign::Choose(const AgentView& agent) const {
  const AgentModel& model = agent.model();
  Member members[kMostSwarm];
  const int swarm = Muster(agent, o_.silent_frames, members);
  struct Goal {
    int target;
    Vec3<double> p_WT;
    double lead_mps;
  };
  Goal goals[kMostTargets];
  int targets = 0;
  for (int k = 0; k < agent.beliefs(); ++k) {
    const int target = agent.first_target() + k;
    if (!agent.belief(target).started) continue;
    const TargetEstimate e = agent.estimate(target);
    const double speed = std::min(std::hypot(e.v_WT.x, e.v_WT.y), model.target.max_speed_mps);
    goals[targets++] = {target, e.p_WT, std::max(o_.fast_mps - speed, kLeastLead_mps)};
  }
  if (targets == 0) return agent.target();
  const int each = std::min((swarm + targets - 1) / targets + 1, kMostPlaces / targets);
  const auto cost = [&](int row, int column) {
    const Member& m = members[row];
    const Goal& goal = goals[column / each];
    const int place = column % each;
    const double d = std::hypot(goal.p_WT.x - m.p_W.x, goal.p_WT.y - m.p_W.y);
    const double way_s = std::max(0.0, d - model.task.desired_distance_m) / goal.lead_mps;
    const int beyond = place - o_.least + 1;
    const double place_s =
        beyond <= 0 ? way_s + kUnmanned_s * (beyond - 1) : o_.extra * way_s + o_.load_s * beyond;
    return place_s - (m.follows == goal.target ? o_.hysteresis_s : 0.0);
  };
  AssignmentSolver<kMostSwarm, kMostPlaces> solver;
  solver.Solve(swarm, each * targets, cost);
  return goals[solver.column_of(0) / each].target;
}

void Describe(AssignOptions* o, config::Table* t) {
  t->Add("load", &o->load_s, NonNegative(1e5), "s",
         "added cost of a target for each AUV beyond the number `least`");
  t->Add("extra", &o->extra, config::kFraction, "-",
         "share of the way to the target that counts for an AUV beyond the number `least`");
  t->Add("hysteresis", &o->hysteresis_s, NonNegative(1e5), "s",
         "an AUV changes its target only where another costs less by this much, and not before "
         "this time since its last change");
  t->Add("least", &o->least, config::Within(1, 16), "AUVs",
         "number of AUVs that each target should have");
  t->Add("period", &o->period_s, NonNegative(1e5), "s", "time between two choices of a target");
  t->Add("silent", &o->silent_frames, NonNegative(1e3), "frames",
         "an AUV that has been silent for so many frames counts as gone");
  t->Add("fast", &o->fast_mps, NonNegative(100), "m/s", "largest speed over ground");
  t->Add("form", &o->form, config::Within(0.0, 1.0), "-",
         "0: the AUV circles its target; 1: it keeps a place in a formation around it");
}

std::unique_ptr<Controller> MakeAssign(const AssignOptions& options) {
  return std::make_unique<Assign>(options);
}

}  // namespace stg::agent
