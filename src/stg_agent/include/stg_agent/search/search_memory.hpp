#pragma once

#include <vector>

#include "stg_agent/graph/neighbour_table.hpp"
#include "stg_agent/search/search_map.hpp"

namespace stg::agent {

/// The plan of a search law, kept between decisions.
struct SearchPlan {
  bool made = false;    ///< false: the next two have no meaning
  TimeNs time = 0;      ///< time of the plan
  double course = 0.0;  ///< [rad], from east anticlockwise
  int leg = 0;          ///< leg of a pattern; -1: the AUV approaches the target
  bool turned = false;  ///< the pattern starts at its other end
};

/// The search of one AUV: its datum, its map and its law's plan. The map takes the AUV's own looks
/// and those in the neighbours' packets. A packet without a measurement means that its sender
/// looked from its position and detected nothing. Deterministic; the result does not depend on the
/// order of packets and detections between two updates.
class SearchMemory {
 public:
  explicit SearchMemory(const AgentModel& model);

  /// Starts an episode.
  void Start(const dynamics::Cue& cue);
  /// Takes an own detection of the target; Update uses the newest one.
  void Detect(const dynamics::Detection& detection);
  /// Brings the map to `now`. @param p_WB own position at `now`, from the navigation [m]
  void Update(TimeNs now, const Vec3<double>& p_WB, const NeighbourTable& neighbours);

  const SearchMap& map() const { return map_; }
  const dynamics::Cue& cue() const { return cue_; }
  TimeNs now() const { return now_; }

  SearchPlan plan;

 private:
  struct Heard {
    TimeNs generation = -1, sighting = -1;  ///< newest ones in the map
  };
  void Hear(const NeighbourState& packet, Heard* heard);
  /// Takes a due look. The result of a ping is known only when the next one is due.
  void LookInVain(const Vec3<double>& p_WB);

  SearchMap map_;
  TimeNs period_;  // between two own looks; 0: every update
  dynamics::Cue cue_;
  dynamics::Detection detection_;
  bool detected_ = false;
  // For looks by pings: position at the last request, and whether there was an answer.
  bool pings_, asked_ = false, answered_ = false;
  Vec3<double> p_asked_;
  TimeNs now_ = 0;
  std::vector<Heard> heard_;  // [agents]
};

}  // namespace stg::agent
