#pragma once

#include <vector>

#include "stg_agent/graph/neighbour_table.hpp"
#include "stg_agent/search/search_map.hpp"

namespace stg::agent {

/// What a law that searches remembers from decision to decision.
struct SearchPlan {
  bool made = false;    ///< false: the next two mean nothing
  TimeNs time = 0;      ///< when it was made
  double course = 0.0;  ///< [rad], from east anticlockwise
  int leg = 0;          ///< of a pattern of legs; -1: it closes in
  bool turned = false;  ///< the pattern starts at its other end
};

/// The search of one AUV: its datum, its map and its law's plan. The map takes the own looks, those
/// that neighbours' packets tell of, and theirs in vain: a packet without a measurement says that
/// its sender looked from where it was. Deterministic; the result does not depend on the order in
/// which packets and detections come in between two updates.
class SearchMemory {
 public:
  explicit SearchMemory(const AgentModel& model);

  /// An episode begins; all else is forgotten.
  void Start(const dynamics::Cue& cue);
  /// Own detection of the target; the newest before the next Update counts.
  void Detect(const dynamics::Detection& detection);
  /// Brings the map to `now`. @param p_WB own position then, as navigation states it [m]
  void Update(TimeNs now, const Vec3<double>& p_WB, const NeighbourTable& neighbours);

  const SearchMap& map() const { return map_; }
  const dynamics::Cue& cue() const { return cue_; }
  TimeNs now() const { return now_; }

  SearchPlan plan;

 private:
  struct Heard {
    TimeNs generation = -1, sighting = -1;  ///< newest that the map took
  };
  void Hear(const NeighbourState& packet, Heard* heard);
  /// A look is due. What a ping finds is known only when the next one is.
  void LookInVain(const Vec3<double>& p_WB);

  SearchMap map_;
  TimeNs period_;  // between two own looks; 0: every update
  dynamics::Cue cue_;
  dynamics::Detection detection_;
  bool detected_ = false;
  // Of looks that are pings: where the last one was asked for, and whether it was answered.
  bool pings_, asked_ = false, answered_ = false;
  Vec3<double> p_asked_;
  TimeNs now_ = 0;
  std::vector<Heard> heard_;  // [agents]
};

}  // namespace stg::agent
