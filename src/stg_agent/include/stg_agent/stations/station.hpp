#pragma once

#include <memory>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "stg_agent/inbox/agent_constants.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// One beacon or surface craft: where it truly is, where it says to be, and the packet that it
/// offers. A beacon lies where it was charted, but for the error of the survey. A craft knows its
/// place by satellite, with an error that lasts; it hears the AUVs, finds out where they are as
/// they do themselves, and circles around the middle of those that it heard lately. Its hull
/// follows commands with a lag.
///
/// Use, in every episode: Reset; then for every decision Receive what was heard, and Advance.
/// Deterministic; allocates nothing after construction.
class Station {
 public:
  /// @param station 0-based; its index in the network is that of the last AUV, plus one, plus this
  Station(SharedConstants constants, int station);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Bytes that its modem heard; what does not decode is ignored.
  /// @param r_W true way to the sender when the packet left [m]
  void Receive(const acoustics::Reception& reception, const Vec3<double>& r_W);
  /// To the next decision. @param step its number in the episode
  void Advance(TimeNs now, std::uint32_t step);

  const Vec3<double>& p_W() const { return p_W_; }  ///< true position [m]
  const Vec3<double>& v_W() const { return v_W_; }  ///< true velocity [m/s]
  /// True position near the last Advance [m].
  Vec3<double> At(TimeNs t) const { return p_W_ + v_W_ * Seconds(t - now_); }
  Vec3<double> told_W() const { return p_W_ + error_W_; }
  bool craft() const { return craft_; }
  int member() const { return member_; }
  Packet MakePacket();

 private:
  struct Heard {
    TimeNs stamp = -1;  ///< never
    Vec3<double> p_W, v_W;
    ToldBearing bearing;
    TimeNs told = -1;  ///< the bearing, by a packet; -1: never
  };
  void Err(std::uint32_t step, bool start);
  /// Adds the newest bearing of the AUV whose last one left the longest ago.
  void TellBearing(NeighbourState* state);
  /// Velocity that it wants.
  Vec3<double> Wanted(TimeNs now) const;

  SharedConstants constants_;
  int member_;
  bool craft_;
  Vec3<double> home_W_;
  std::unique_ptr<Localizer> localizer_;
  std::vector<Heard> heard_;  // [agents]
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  TimeNs now_ = 0;
  Vec3<double> p_W_, v_W_, error_W_;
};

}  // namespace stg::agent
