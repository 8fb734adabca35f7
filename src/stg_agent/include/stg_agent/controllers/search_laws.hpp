#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/formation.hpp"

/// Controllers that search for a target that no AUV detects, and surround it when it is found:
/// `search_map`, `greedy_search`, `parallel_sweep`, `expanding_square`. They need the agents'
/// search map (track.search_cell_m).
namespace stg::agent {

/// Whether the target may be faster than the cruise speed of `encircle`. It would leave a circle,
/// so AUVs keep places around it.
bool TooFastToCircle(const AgentModel& model);

/// What all of them do after the target is found.
struct FoundOptions {
  /// The search begins again after this time without an observation. 0: after `give_up_looks`.
  double give_up_s = 0.0;
  double give_up_looks = 6.0;  ///< periods of the sensor
  double fast_mps = 2.3;       ///< largest speed over ground
  /// 0: circle the target, as `encircle`; 1: keep a place, as `formation`; below 0: keep a place if
  /// TooFastToCircle.
  double form = -1.0;
  /// With a standard deviation above this, an estimate may be the mean of several possible places.
  /// The AUV then flies to the most probable place of the map, not around the mean. 0: never.
  double certain_m = 150.0;
  double close_reach_m = 500.0;  ///< distance over which the map's mass counts then
  double close_replan_s = 5.0;   ///< time between two choices of a course then
  double close_keep = 1.1;       ///< factor on the worth of the present course then
  double team_range_m = 600.0;   ///< AUVs farther from the target have no place in the ring
};

void DescribeFound(FoundOptions* o, config::Table* t);

/// Constants of the search by the map.
struct SearchMapOptions : FoundOptions {
  double horizon_s = 480.0;  ///< a course is worth the mass that it sweeps in this time
  double swath = 0.8;        ///< half width of the sweep, as a share of the detection range
  double pull = 0.3;         ///< weight of the mass in the direction of a course
  double pull_m = 1200.0;    ///< distance over which that mass counts
  double replan_s = 20.0;    ///< time between two choices of a course
  double keep = 1.1;         ///< factor on the worth of the present course
  double senior_s = 480.0;   ///< AUVs of a lower index are assumed to keep their course so long
  int courses = 16;
};

/// The same, with values for the next looks only.
struct GreedySearchOptions : SearchMapOptions {
  GreedySearchOptions() {
    horizon_s = 60.0;
    senior_s = 60.0;
    pull_m = 400.0;
  }
};

/// Constants of the patterns.
struct PatternOptions : FoundOptions {
  double spacing = 1.5;  ///< distance between two tracks, as a share of the detection range
  double box = 1.25;  ///< parallel_sweep: half side of the box, as a share of the cue's deviation
  double reached_m = 60.0;
};
struct ParallelSweepOptions : PatternOptions {};
struct ExpandingSquareOptions : PatternOptions {};

void Describe(SearchMapOptions* o, config::Table* t);
void Describe(ParallelSweepOptions* o, config::Table* t);
void Describe(ExpandingSquareOptions* o, config::Table* t);

/// A search law. With an agent's own knowledge it searches while the target is not observed. With
/// true states it follows the target at once.
class SearchLaw : public Controller {
 public:
  explicit SearchLaw(const FoundOptions& found);

  void Act(const ControllerInput<double>& input, double* action) const override;
  void Act(const ControllerInput<Pack>& input, Pack* action) const override;
  /// Throws UserError for an agent without a search map.
  void Act(const AgentView& agent, float* action) const override;
  /// The same law, changed by a guidance and not rounded; during a search, the phase turns the
  /// course.
  /// @param searches search even where the target is observed
  void Act(const AgentView& agent, const Guidance<double>& guidance, bool searches,
           double* action) const;

 protected:
  /// Present goal, relative to the own position [m].
  virtual Level<double> Goal(const AgentView& agent, SearchMemory* search) const = 0;

 private:
  template <class T>
  void Follow(const ControllerInput<T>& input, const Guidance<T>& guidance, T* action) const;
  bool KeepsPlaces(const AgentModel& model) const;
  double GiveUp_s(const AgentModel& model) const;
  /// Whether the target's estimate is certain enough (certain_m).
  bool Certain(const TargetBelief& belief) const;
  /// A point in the direction of most of the near mass, relative to the own position [m].
  Level<double> WayToMass(const AgentView& agent, SearchMemory* search) const;

  FoundOptions found_;
  Encircle circle_;
  Formation form_;
};

/// The course [rad], out of 32 from `course` on, in whose direction most of the map's mass is near.
/// The weight of a cell is the fourth power of the cosine of its angle off the course, times
/// exp(-distance / reach_m).
/// @param keep factor on the worth of `course`
double CourseToMass(const SearchMap& map, const Vec3<double>& p_WB, double reach_m, double course,
                    double keep);

/// The `leg`-th waypoint of an AUV's pattern, world axes [m].
/// @param id, agents index of the AUV, and number of AUVs @param spacing_m distance between two
/// tracks
Level<double> SquareWaypoint(const Level<double>& datum, double spacing_m, int id, int agents,
                             int leg);
/// Tracks from south to north and back in one strip of the box, from west to east; the last one is
/// followed by the first. @param half_m half side of the box @param turned begins in the north
Level<double> SweepWaypoint(const Level<double>& datum, double half_m, double spacing_m, int id,
                            int agents, int leg, bool turned);

std::unique_ptr<SearchLaw> MakeSearchMap(const SearchMapOptions& options);
std::unique_ptr<Controller> MakeGreedySearch(const GreedySearchOptions& options);
std::unique_ptr<Controller> MakeParallelSweep(const ParallelSweepOptions& options);
std::unique_ptr<Controller> MakeExpandingSquare(const ExpandingSquareOptions& options);

}  // namespace stg::agent
