#include "stg_agent/controllers/search_laws.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "auv_common/error.hpp"

namespace stg::agent {
namespace {

using config::NonNegative;

constexpr int kCourses = 64;
/// Value of a plan's leg if the course leads to a target that was found.
constexpr int kCloseIn = -1;

Encircle CircleOf(const FoundOptions& found) {
  EncircleOptions o;
  o.fast_mps = found.fast_mps;
  return {o};
}

Formation FormOf(const FoundOptions& found) {
  FormationOptions o;
  o.fast_mps = found.fast_mps;
  o.team_range_m = found.team_range_m;
  return {o};
}

/// Chooses the course that covers the most probability (Koopman 1956; Stone 1975).
class MapLaw final : public SearchLaw {
 public:
  explicit MapLaw(const SearchMapOptions& options) : SearchLaw(options), o_(options) {}

 private:
  /// A course that an AUV flies for some time.
  struct Track {
    Level<double> start, direction;
    double length_m = 0.0;
  };

  static bool Covers(const Track& track, double half_m, double x, double y) {
    const Level<double> r{x - track.start.x, y - track.start.y};
    const double along = Dot(r, track.direction);
    return along > -half_m && along < track.length_m + half_m &&
           std::abs(Cross(track.direction, r)) < half_m;
  }

  Level<double> Goal(const AgentView& agent, SearchMemory* search) const override {
    SearchPlan& plan = search->plan;
    if (!plan.made || Seconds(search->now() - plan.time) >= o_.replan_s) {
      plan.course = Choose(agent, *search);
      plan.time = search->now();
      plan.made = true;
    }
    constexpr double kFar_m = 1e4;
    return {kFar_m * std::cos(plan.course), kFar_m * std::sin(plan.course)};
  }

  /// Courses of the AUVs with lower numbers. What they will search is left to them.
  std::vector<Track> SeniorTracks(const AgentView& agent) const {
    std::vector<Track> tracks;
    for (const int id : agent.neighbours().known()) {
      if (id > agent.id()) break;
      const NeighbourSight<double> n = agent.sight(id);
      const Level<double> v{n.v_W.x, n.v_W.y};
      const double speed = std::max(Norm(v), 1e-3);
      tracks.push_back({{n.p_WN.x, n.p_WN.y}, v * (1.0 / speed), speed * o_.senior_s});
    }
    return tracks;
  }

  double Choose(const AgentView& agent, const SearchMemory& search) const {
    const SearchMap& map = search.map();
    const Vec3<double>& p_WB = agent.knowledge().p_WB;
    const double half_m = o_.swath * agent.model().sensing.range_m;
    const double length_m = o_.horizon_s * o_.fast_mps;
    const std::vector<Track> seniors = SeniorTracks(agent);
    std::array<double, kCourses> worth{}, cosine{}, sine{};
    const auto courses = static_cast<std::size_t>(o_.courses);
    for (std::size_t k = 0; k < courses; ++k) {
      // The directions start at the present course, so that it is one of them.
      const double course = search.plan.course + 2.0 * kPi * static_cast<double>(k) / o_.courses;
      cosine[k] = std::cos(course);
      sine[k] = std::sin(course);
    }
    for (int r = 0; r < SearchMap::kSide; ++r) {
      for (int c = 0; c < SearchMap::kSide; ++c) {
        double mass = map.mass(r, c);
        if (mass < 1e-7) continue;
        for (const Track& track : seniors) {
          if (Covers(track, half_m, map.x(c), map.y(r))) mass = 0.0;
        }
        if (mass == 0.0) continue;
        const double x = map.x(c) - p_WB.x, y = map.y(r) - p_WB.y;
        const double d = std::sqrt(x * x + y * y) + 1e-3;
        const double pull = o_.pull * std::exp(-d / o_.pull_m);
        // An earlier search of a place is worth more.
        const double swept = 1.0 - 0.5 * std::min(1.0, d / length_m);
        for (std::size_t k = 0; k < courses; ++k) {
          const double along = x * cosine[k] + y * sine[k];
          const double across = std::abs(x * sine[k] - y * cosine[k]);
          if (along > 0.0) {
            const double cos2 = along * along / (d * d);
            worth[k] += mass * pull * cos2 * cos2;
          }
          if (across < half_m && along > -half_m && along < length_m) worth[k] += mass * swept;
        }
      }
    }
    if (search.plan.made) worth[0] *= o_.keep;
    std::size_t best = 0;
    for (std::size_t k = 1; k < courses; ++k) {
      if (worth[k] > worth[best]) best = k;
    }
    return std::atan2(sine[best], cosine[best]);
  }

  SearchMapOptions o_;
};

}  // namespace

bool TooFastToCircle(const AgentModel& model) {
  return model.target.max_speed_mps > EncircleOptions{}.cruise_mps;
}

void DescribeFound(FoundOptions* o, config::Table* t) {
  t->Add(
      "give-up", &o->give_up_s, NonNegative(1e5), "s",
      "the search begins again after this time without an observation; 0: after `give-up-looks`");
  t->Add("give-up-looks", &o->give_up_looks, NonNegative(1e4), "-",
         "with give-up=0: periods of the sensor after which the search begins again");
  t->Own("give-up-looks", {"give-up", {"0"}, "give-up", [o] {
                             return std::vector<std::string>{o->give_up_s > 0.0 ? "a time" : "0"};
                           }});
  t->Add("fast", &o->fast_mps, NonNegative(100), "m/s", "largest speed over ground");
  t->Add("form", &o->form, {-1.0, 1.0}, "-",
         "after the target is found, 0: the AUV circles it, as encircle; 1: it keeps a place, as "
         "formation; -1: it keeps a place if the target may be faster than encircle's cruise");
  t->Add("certain", &o->certain_m, NonNegative(1e5), "m",
         "the AUV approaches the target by the map while the estimate's standard deviation is "
         "above this; 0: never");
  t->Add("close-reach", &o->close_reach_m, config::Positive(1e5), "m",
         "distance over which the map's mass counts during that approach");
  t->Add("close-replan", &o->close_replan_s, NonNegative(1e5), "s",
         "time between two choices of a course during that approach");
  t->Add("close-keep", &o->close_keep, NonNegative(100), "-",
         "factor on the worth of the present course during that approach");
  t->Add("team-range", &o->team_range_m, NonNegative(1e5), "m",
         "AUVs farther from the target than this have no place in the ring");
  t->Own("team-range", {"form", {"places"}, "form", [o] {
                          return std::vector<std::string>{o->form == 0.0 ? "circle" : "places"};
                        }});
  for (const char* key : {"close-reach", "close-replan", "close-keep"}) {
    t->Own(key, {"certain", {"above 0"}, "certain", [o] {
                   return std::vector<std::string>{o->certain_m > 0.0 ? "above 0" : "0"};
                 }});
  }
}

SearchLaw::SearchLaw(const FoundOptions& found)
    : found_(found), circle_(CircleOf(found)), form_(FormOf(found)) {}

template <class T>
void SearchLaw::Follow(const ControllerInput<T>& in, const Guidance<T>& guidance, T* action) const {
  if (KeepsPlaces(in.model)) {
    form_.Act(in, guidance, action);
  } else {
    circle_.Act(in, guidance, action);
  }
}

bool SearchLaw::KeepsPlaces(const AgentModel& model) const {
  if (found_.form >= 0.0) return found_.form > 0.5;
  return TooFastToCircle(model);
}

double SearchLaw::GiveUp_s(const AgentModel& model) const {
  if (found_.give_up_s > 0.0) return found_.give_up_s;
  return found_.give_up_looks * model.look_period_s();
}

void SearchLaw::Act(const ControllerInput<double>& in, double* action) const {
  Follow(in, {}, action);
}
void SearchLaw::Act(const ControllerInput<Pack>& in, Pack* action) const { Follow(in, {}, action); }

void SearchLaw::Act(const AgentView& agent, float* action) const {
  double a[dynamics::kMaxActionSize] = {};
  Act(agent, {}, false, a);
  for (int i = 0; i < agent.model().control.action_size(); ++i)
    action[i] = static_cast<float>(a[i]);
}

void SearchLaw::Act(const AgentView& agent, const Guidance<double>& guidance, bool searches,
                    double* action) const {
  SearchMemory* search = agent.search();
  if (search == nullptr) {
    throw UserError(
        "this controller needs the agents' search map: set track.search_cell_m above 0");
  }
  const NearestSights nearest = agent.Nearest();
  Knowledge<double> k = agent.knowledge();
  const ControllerInput<double> in{agent.model(), agent.id(), k, nearest.begin(), nearest.size()};
  const TargetBelief belief = agent.belief();
  const bool found = !searches && belief.started && belief.observed &&
                     Seconds(search->now() - belief.information) <= GiveUp_s(agent.model());
  if (found && Certain(belief)) {
    search->plan.made = false;
    Follow(in, guidance, action);
  } else {
    // A search plan and a plan to close in are not valid for each other.
    SearchPlan& plan = search->plan;
    const bool closes_in = plan.leg == kCloseIn;
    if (closes_in != found) plan.made = false;
    plan.leg = found ? kCloseIn : closes_in ? 0 : plan.leg;
    // The way to the goal is a circle around it, far away; so the law also avoids other AUVs and
    // the chart's obstacles.
    const Level<double> goal = found ? WayToMass(agent, search) : Goal(agent, search);
    const double c = std::cos(guidance.phase_rad), s = std::sin(guidance.phase_rad);
    k.r_BT_W.x = c * goal.x - s * goal.y;
    k.r_BT_W.y = s * goal.x + c * goal.y;
    k.v_WT = {};
    Guidance<double> way;
    way.speed_mps = guidance.speed_mps;
    way.depth_m = guidance.depth_m;
    circle_.Act(in, way, action);
  }
}

bool SearchLaw::Certain(const TargetBelief& belief) const {
  const double square = belief.P_WT.xx + belief.P_WT.yy;
  return found_.certain_m <= 0.0 || square <= found_.certain_m * found_.certain_m;
}

double CourseToMass(const SearchMap& map, const Vec3<double>& p_WB, double reach_m, double course,
                    double keep) {
  constexpr std::size_t kWays = 32;
  constexpr double kLeastMass = 1e-4;
  std::array<double, kWays> worth{}, cosine{}, sine{};
  const auto way = [&](std::size_t k) {
    return course + 2.0 * kPi * static_cast<double>(k) / kWays;
  };
  for (std::size_t k = 0; k < kWays; ++k) {
    cosine[k] = std::cos(way(k));
    sine[k] = std::sin(way(k));
  }
  for (int r = 0; r < SearchMap::kSide; ++r) {
    for (int c = 0; c < SearchMap::kSide; ++c) {
      const double mass = map.mass(r, c);
      if (mass < kLeastMass) continue;
      const double x = map.x(c) - p_WB.x, y = map.y(r) - p_WB.y;
      const double d = std::sqrt(x * x + y * y) + 1e-3;
      const double pull = mass * std::exp(-d / reach_m);
      for (std::size_t k = 0; k < kWays; ++k) {
        const double along = (x * cosine[k] + y * sine[k]) / d;
        if (along > 0.0) worth[k] += pull * along * along * along * along;
      }
    }
  }
  worth[0] *= keep;
  const auto best = std::max_element(worth.begin(), worth.end()) - worth.begin();
  return std::remainder(way(static_cast<std::size_t>(best)), 2.0 * kPi);
}

Level<double> SearchLaw::WayToMass(const AgentView& agent, SearchMemory* search) const {
  constexpr double kFar_m = 1e4;
  SearchPlan& plan = search->plan;
  if (!plan.made || Seconds(search->now() - plan.time) >= found_.close_replan_s) {
    plan.course = CourseToMass(search->map(), agent.knowledge().p_WB, found_.close_reach_m,
                               plan.course, plan.made ? found_.close_keep : 1.0);
    plan.time = search->now();
    plan.made = true;
  }
  return {kFar_m * std::cos(plan.course), kFar_m * std::sin(plan.course)};
}

void Describe(SearchMapOptions* o, config::Table* t) {
  DescribeFound(o, t);
  t->Add("horizon", &o->horizon_s, NonNegative(1e5), "s",
         "a course is worth the map's mass that it sweeps in this time");
  t->Add("swath", &o->swath, NonNegative(10), "-",
         "half width of the sweep, as a share of the detection range");
  t->Add("pull", &o->pull, NonNegative(100), "-",
         "weight of the map's mass in the direction of a course");
  t->Add("pull-range", &o->pull_m, config::Positive(1e5), "m",
         "distance over which that mass counts");
  t->Add("replan", &o->replan_s, NonNegative(1e5), "s", "time between two choices of a course");
  t->Add("keep", &o->keep, NonNegative(100), "-", "factor on the worth of the present course");
  t->Add("senior", &o->senior_s, NonNegative(1e5), "s",
         "AUVs of a lower index are assumed to keep their course for this time");
  t->Add("courses", &o->courses, config::Within(4, kCourses), "-",
         "number of courses to choose from");
}

std::unique_ptr<SearchLaw> MakeSearchMap(const SearchMapOptions& options) {
  return std::make_unique<MapLaw>(options);
}

std::unique_ptr<Controller> MakeGreedySearch(const GreedySearchOptions& options) {
  return std::make_unique<MapLaw>(options);
}

}  // namespace stg::agent
