#pragma once

#include <memory>

#include "stg_agent/controllers/encircle.hpp"
#include "stg_agent/controllers/formation.hpp"

/// Controllers that look for a target that no AUV sees, and circle it once it is found:
/// `search_map`, `greedy_search`, `parallel_sweep`, `expanding_square`. They need the agents'
/// search map (track.search_cell_m).
namespace stg::agent {

/// What all of them do with a target that is found.
struct FoundOptions {
  double give_up_s = 120.0;  ///< without an observation for so long the search begins again
  double fast_mps = 2.3;     ///< over ground, at most
  double form = 0.0;  ///< 0: circles the target as `encircle`; 1: keeps a place as `formation`
  /// An estimate that is off by more than this, as it states, is one of several: the AUV flies to
  /// where the map says that the target is, instead of around the middle of them. 0: never.
  double certain_m = 0.0;
  double close_reach_m = 500.0;  ///< how far the mass counts then
  double team_range_m = 600.0;   ///< form=1: others farther from the target have no place
};

void DescribeFound(FoundOptions* o, config::Table* t);

/// Constants of the search by the map.
struct SearchMapOptions : FoundOptions {
  double horizon_s = 480.0;  ///< the mass swept in this time counts
  double swath = 0.8;        ///< half width of the sweep, as a share of the detection range
  double pull = 0.3;         ///< weight of the mass in a direction, near or far
  double pull_m = 1200.0;    ///< how far that reaches
  double replan_s = 20.0;    ///< between two choices of a course
  double keep = 1.1;         ///< the old course is worth this times as much
  double senior_s = 480.0;   ///< those senior are taken to fly on for so long
  int courses = 16;
};

/// The same for what the next looks find.
struct GreedySearchOptions : SearchMapOptions {
  GreedySearchOptions() {
    horizon_s = 60.0;
    senior_s = 60.0;
    pull_m = 400.0;
  }
};

/// Constants of the patterns.
struct PatternOptions : FoundOptions {
  double spacing = 1.5;  ///< between two tracks, as a share of the detection range
  double box = 1.25;  ///< parallel_sweep: half side of the box, as a share of the cue's deviation
  double reached_m = 60.0;
};
struct ParallelSweepOptions : PatternOptions {};
struct ExpandingSquareOptions : PatternOptions {};

void Describe(SearchMapOptions* o, config::Table* t);
void Describe(ParallelSweepOptions* o, config::Table* t);
void Describe(ExpandingSquareOptions* o, config::Table* t);

/// A law that searches. From an agent's own knowledge it searches while the target is not observed;
/// from true states, which leave nothing to search, it follows the target at once.
class SearchLaw : public Controller {
 public:
  explicit SearchLaw(const FoundOptions& found);

  void Act(const ControllerInput<double>& input, double* action) const override;
  void Act(const ControllerInput<Pack>& input, Pack* action) const override;
  /// Throws UserError for an agent without a search map.
  void Act(const AgentView& agent, float* action) const override;
  /// The same law, guided, not rounded: while it searches the phase turns its course.
  /// @param searches it searches although the target is observed
  void Act(const AgentView& agent, const Guidance<double>& guidance, bool searches,
           double* action) const;

 protected:
  /// Where to go now, relative to the own position [m].
  virtual Level<double> Goal(const AgentView& agent, SearchMemory* search) const = 0;

 private:
  template <class T>
  void Follow(const ControllerInput<T>& input, const Guidance<T>& guidance, T* action) const;
  /// Whether the AUV knows one place of its target.
  bool Certain(const TargetBelief& belief) const;
  /// The course to most of the mass that is near, relative to the own position.
  Level<double> WayToMass(const AgentView& agent, SearchMemory* search) const;

  FoundOptions found_;
  Encircle circle_;
  Formation form_;
};

/// The course, of 32 from `course` on, on which most of a map's mass lies nearby [rad]: a cell
/// counts by the fourth power of the cosine of its angle off the course and fades with `reach_m`.
/// @param keep the course that it counts from is worth this times as much
double CourseToMass(const SearchMap& map, const Vec3<double>& p_WB, double reach_m, double course,
                    double keep);

/// Of an AUV the `leg`-th waypoint of its pattern, world axes [m].
/// @param id, agents which of how many @param spacing_m between two tracks
Level<double> SquareWaypoint(const Level<double>& datum, double spacing_m, int id, int agents,
                             int leg);
/// Tracks from south to north and back in one strip of the box, from west to east; after the last
/// one again the first. @param half_m of the box's side @param turned begins in the north
Level<double> SweepWaypoint(const Level<double>& datum, double half_m, double spacing_m, int id,
                            int agents, int leg, bool turned);

std::unique_ptr<SearchLaw> MakeSearchMap(const SearchMapOptions& options);
std::unique_ptr<Controller> MakeGreedySearch(const GreedySearchOptions& options);
std::unique_ptr<Controller> MakeParallelSweep(const ParallelSweepOptions& options);
std::unique_ptr<Controller> MakeExpandingSquare(const ExpandingSquareOptions& options);

}  // namespace stg::agent
