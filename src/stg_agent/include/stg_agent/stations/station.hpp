#pragma once

#include <memory>
#include <vector>

#include "acoustic_channel/modem/packet.hpp"
#include "stg_agent/inbox/agent_constants.hpp"
#include "stg_agent/localization/localizer.hpp"
#include "stg_agent/localization/measured_ranges.hpp"
#include "stg_agent/packet/packet.hpp"

namespace stg::agent {

/// One beacon or surface craft: its true position, its stated position, and its packet. A beacon
/// lies at its charted position, apart from the error of the survey. It measures ranges from the
/// packets that it receives, and sends them in its own packets. A craft measures its position
/// by satellite, with a lasting error. It receives the AUVs' packets, estimates their positions as
/// the AUVs do, and circles around the middle of those that it heard lately. Its hull follows
/// commands with a lag.
///
/// Use in each episode: Reset; then, for each decision, Receive for each received packet, and
/// Advance. Deterministic; allocates nothing after construction.
class Station {
 public:
  /// @param station 0-based; its index in the network is the number of AUVs plus this
  Station(SharedConstants constants, int station);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Takes a packet from its modem; one that cannot be decoded is ignored.
  /// @param r_W true vector to the sender when the packet left [m]
  void Receive(const acoustics::Reception& reception, const Vec3<double>& r_W);
  /// Moves to the next decision. @param step its number in the episode
  void Advance(TimeNs now, std::uint32_t step);

  const Vec3<double>& p_W() const { return p_W_; }  ///< true position [m]
  const Vec3<double>& v_W() const { return v_W_; }  ///< true velocity [m/s]
  /// True position at a time near the last Advance [m].
  Vec3<double> At(TimeNs t) const { return p_W_ + v_W_ * Seconds(t - now_); }
  Vec3<double> stated_W() const { return p_W_ + error_W_; }
  bool craft() const { return craft_; }
  int member() const { return member_; }
  Packet MakePacket();

 private:
  struct Heard {
    TimeNs stamp = -1;  ///< never
    Vec3<double> p_W, v_W;
    SentBearing bearing;
    TimeNs sent = -1;  ///< when its bearing was last sent; -1: never
  };
  void Err(std::uint32_t step, bool start);
  /// Measures the range of a received packet by its travel time.
  void MeasureRange(const NeighbourState& state, const acoustics::Reception& reception);
  /// Adds the newest bearing of the AUV whose bearing was sent longest ago.
  void TellBearing(NeighbourState* state);
  /// Commanded velocity [m/s].
  Vec3<double> Wanted(TimeNs now) const;

  SharedConstants constants_;
  int member_;
  bool craft_;
  Vec3<double> home_W_;
  acoustics::SoundSpeedProfile sound_;
  std::unique_ptr<Localizer> localizer_;    // of a craft
  std::unique_ptr<MeasuredRanges> ranges_;  // of a beacon, if ranges are travel times
  std::vector<Heard> heard_;                // [agents]
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  TimeNs now_ = 0;
  Vec3<double> p_W_, v_W_, error_W_;
};

}  // namespace stg::agent
