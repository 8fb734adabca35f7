#pragma once

#include <vector>

#include "acoustic_channel/link/link_estimator.hpp"
#include "auv_common/numbers/lane_structs.hpp"
#include "stg_agent/agent_config.hpp"
#include "stg_agent/graph/knowledge.hpp"
#include "stg_agent/graph/neighbour_table.hpp"

/// The neighbours of one AUV (T = double), or of the same AUV in kLanes environments (T = Pack):
/// the newest report of each one, and its prediction for the present decision.
namespace stg::agent {

/// Dead reckoning p + v age inside the walls [m].
template <class T>
Vec3<T> DeadReckon(const Vec3<T>& p_W, const Vec3<T>& v_W, const T& age_s, double wall_m) {
  return Clip(p_W + v_W * age_s, -wall_m, wall_m);
}

/// One neighbour. World axes.
template <class T>
struct NeighbourSight {
  T known = T(0.0);  ///< 1; 0: the other fields have no meaning
  // From the report.
  Vec3<T> p_W, v_W;  ///< [m], [m/s], at the time generation_ns
  T generation_ns = T(0.0), tracking_error = T(0.0);
  // Predicted to the present.
  T age_s = T(0.0);         ///< of the report, not negative
  Vec3<T> p_WN;             ///< dead-reckoned position p + v age, inside the walls [m]
  Vec3<T> r_BN_W;           ///< p_WN minus own position [m]
  T distance_m = T(0.0);    ///< length of r_BN_W
  T link_quality = T(0.0);  ///< at this distance and age

  /// Whether it is known in any lane.
  bool heard() const { return Any(known > T(0.5)); }
};

/// One lane of sights, [agents]. It refers to the Neighbourhood from which it comes.
class SightReader {
 public:
  SightReader(const std::vector<NeighbourSight<double>>& sights, int) : one_(sights.data()) {}
  SightReader(const std::vector<NeighbourSight<Pack>>& sights, int lane)
      : lanes_(sights.data()), lane_(lane) {}

  NeighbourSight<double> at(int id) const {
    return one_ != nullptr ? one_[id] : LaneOf(lanes_[id], lane_);
  }
  double distance_m(int id) const {
    return one_ != nullptr ? one_[id].distance_m : Lane(lanes_[id].distance_m, lane_);
  }

 private:
  const NeighbourSight<double>* one_ = nullptr;  // either this
  const NeighbourSight<Pack>* lanes_ = nullptr;  // or this
  int lane_ = 0;
};

/// Stores all neighbours of an AUV. Each lane has a table with the contents of packets. The sights
/// have the values of all tables that a decision needs, side by side. Both always change together.
/// The capacity is fixed (the swarm), and nothing is allocated after construction.
template <class T>
class Neighbourhood {
 public:
  using Sights = std::vector<NeighbourSight<T>>;

  /// @param self the AUV whose neighbours these are
  Neighbourhood(const AgentModel& model, int self);

  /// Forgets all neighbours in a lane.
  void Clear(int lane);
  /// Takes a packet's content in a lane; see NeighbourTable::Update.
  bool Update(int lane, const NeighbourState& state);
  /// Forgets neighbours silent for too long at time `now`.
  void Forget(int lane, TimeNs now);

  /// Sets the ages of all reports at a time; true where one is older than
  /// track.neighbour_max_age_s.
  Mask<T> Age(const T& now_ns);
  /// Predicts all neighbours by the ages of their reports, relative to the own position p_WB [m].
  void Predict(const Vec3<T>& p_WB, const acoustics::LinkEstimator& links);
  /// Restores the sights of the lanes outside the mask from `before`.
  void KeepOthers(const Mask<T>& lanes, const Sights& before);

  /// [agents]; the own one is never known.
  const Sights& sights() const { return sights_; }
  /// The packets' contents of one lane.
  const NeighbourTable& table(int lane) const { return tables_[static_cast<std::size_t>(lane)]; }
  /// Marks the target estimates of a lane as read.
  void MarkRead(int lane) { tables_[static_cast<std::size_t>(lane)].MarkRead(); }

 private:
  double max_age_s_, wall_m_;
  std::vector<NeighbourTable> tables_;  // [lanes]
  Sights sights_;
  // [agents] padded to whole packs; T = double
  std::vector<double> distance_, age_, learnt_, quality_;
};

}  // namespace stg::agent
