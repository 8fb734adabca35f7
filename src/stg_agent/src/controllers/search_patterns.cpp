#include <algorithm>
#include <cmath>

#include "stg_agent/controllers/search_laws.hpp"

/// Search patterns with legs that are known in advance (IAMSAR manual, volume III).
namespace stg::agent {
namespace {

void DescribePattern(PatternOptions* o, config::Table* t) {
  DescribeFound(o, t);
  t->Add("spacing", &o->spacing, config::Positive(10), "-",
         "distance between two tracks, as a share of the detection range");
  t->Add("reached", &o->reached_m, config::Positive(1e4), "m",
         "distance within which a waypoint counts as reached");
}

/// Flies to one waypoint after the other.
class Pattern : public SearchLaw {
 public:
  explicit Pattern(const PatternOptions& options) : SearchLaw(options), o_(options) {}

 protected:
  /// Waypoint of the plan's leg.
  virtual Level<double> Waypoint(const AgentView& agent, const SearchMemory& search) const = 0;
  /// Called before the first leg.
  virtual void Begin(const AgentView& agent, SearchMemory* search) const = 0;
  static Level<double> Datum(const SearchMemory& search) {
    return {search.cue().p_WT.x, search.cue().p_WT.y};
  }

  PatternOptions o_;

 private:
  Level<double> Goal(const AgentView& agent, SearchMemory* search) const override {
    if (!search->plan.made) {
      Begin(agent, search);
      search->plan.made = true;
    }
    const Vec3<double>& p_WB = agent.knowledge().p_WB;
    const Level<double> own{p_WB.x, p_WB.y};
    Level<double> goal = Waypoint(agent, *search) - own;
    if (Norm(goal) < o_.reached_m + agent.model().task.desired_distance_m) {
      ++search->plan.leg;
      goal = Waypoint(agent, *search) - own;
    }
    // The goal is moved far ahead in the same direction, because near a waypoint the law would
    // circle.
    return goal * (1e4 / std::max(Norm(goal), 1.0));
  }
};

class ExpandingSquare final : public Pattern {
 public:
  using Pattern::Pattern;

 private:
  Level<double> Waypoint(const AgentView& agent, const SearchMemory& search) const override {
    const AgentModel& s = agent.model();
    return SquareWaypoint(Datum(search), o_.spacing * s.sensing.range_m, agent.id(), s.run.agents,
                          search.plan.leg);
  }
  void Begin(const AgentView&, SearchMemory* search) const override { search->plan.leg = 0; }
};

class ParallelSweep final : public Pattern {
 public:
  using Pattern::Pattern;

 private:
  double Half(const SearchMemory& search) const { return o_.box * search.cue().std_m; }
  Level<double> Waypoint(const AgentView& agent, const SearchMemory& search) const override {
    const AgentModel& s = agent.model();
    return SweepWaypoint(Datum(search), Half(search), o_.spacing * s.sensing.range_m, agent.id(),
                         s.run.agents, search.plan.leg, search.plan.turned);
  }
  void Begin(const AgentView& agent, SearchMemory* search) const override {
    search->plan.leg = 0;
    search->plan.turned = agent.knowledge().p_WB.y > search->cue().p_WT.y;
  }
};

}  // namespace

Level<double> SquareWaypoint(const Level<double>& datum, double spacing_m, int id, int agents,
                             int leg) {
  // Legs of 1, 1, 2, 2, ... spacings. Each turns a quarter from the one before.
  const double turn = 2.0 * kPi * id / std::max(1, agents);
  Level<double> p = datum;
  for (int k = 0; k < leg; ++k) {
    const double course = turn + 0.5 * kPi * (k % 4);
    const int longer = k / 2;
    const double length = spacing_m * (1 + longer);
    p = p + Level<double>{length * std::cos(course), length * std::sin(course)};
  }
  return p;
}

Level<double> SweepWaypoint(const Level<double>& datum, double half_m, double spacing_m, int id,
                            int agents, int leg, bool turned) {
  const double width = 2.0 * half_m / std::max(1, agents);
  const int tracks = std::max(1, static_cast<int>(std::ceil(width / spacing_m - 1e-9)));
  const int track = (leg / 2) % tracks;
  const bool north = ((leg + 1) / 2 % 2 == 1) != turned;
  const double x = datum.x - half_m + width * id + (track + 0.5) * width / tracks;
  return {x, datum.y + (north ? half_m : -half_m)};
}

void Describe(ParallelSweepOptions* o, config::Table* t) {
  DescribePattern(o, t);
  t->Add("box", &o->box, config::Positive(10), "-",
         "half side of the box around the datum, as a share of its deviation");
}

void Describe(ExpandingSquareOptions* o, config::Table* t) { DescribePattern(o, t); }

std::unique_ptr<Controller> MakeParallelSweep(const ParallelSweepOptions& options) {
  return std::make_unique<ParallelSweep>(options);
}

std::unique_ptr<Controller> MakeExpandingSquare(const ExpandingSquareOptions& options) {
  return std::make_unique<ExpandingSquare>(options);
}

}  // namespace stg::agent
