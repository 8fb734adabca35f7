#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// The pings by which AUVs range each other and the stations (localization.ranges.by), and their
/// targets (sensing.ranging). Each such target has a transponder, which only answers; transponders
/// are the last nodes of the network. An AUV asks its modem for a ping. The request waits for the
/// AUV's turn on the channel, is sent before its packet, and may be lost. The sensor's keys for
/// range, probability and error also apply to the transponders: one that is too far away, or misses
/// the look, does not answer.
///
/// Use in each episode: Reset; then, for each decision, Ask, the channel's Step, and Take after
/// each Deliver. It observes the channel, to get the results of the pings.
class AuvPings : public acoustics::PacketObserver {
 public:
  /// @param sensing true sensing
  AuvPings(const AgentModel& model, const dynamics::SensingConfig& sensing);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Asks the AUVs' modems for the pings that are due at decision `step`.
  /// @param p_W positions of all nodes, in the order of `water`
  void Ask(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
           acoustics::Channel* water);
  /// Adds the answers that AUV `receiver` got by `until`, each once, in order of time among the
  /// receptions from `first` on.
  void Take(int receiver, TimeNs until, std::size_t first, std::vector<acoustics::Reception>* out);
  const acoustics::PingTotals& totals() const { return totals_; }

  void OnSent(const acoustics::PacketInfo& packet) override;
  void OnPing(const acoustics::PingResult& ping) override;

 private:
  struct Pinger {
    bool look_due = false, member_due = false;  ///< a ping is due and not requested yet
    int last_member = -1;
    bool waits = false;                ///< a request is not sent yet
    TimeNs sent = -1;                  ///< when the open request was sent; -1: no open request
    double error = 0.0;                ///< of the requested range, in standard deviations
    std::uint32_t asked = 0, tag = 0;  ///< number of requests, and tag of the newest one
    bool answered = false;             ///< the next field is valid
    acoustics::Reception answer;
  };
  int TargetOf(int auv) const;
  int NextMember(int auv) const;
  /// Node of a target's transponder, or kToNone where it does not answer.
  int AskTarget(int auv, std::uint32_t step, const std::vector<Vec3<double>>& p_W);

  RunConfig run_;
  FleetConfig fleet_;
  dynamics::TargetConfig target_;
  bool free_;
  dynamics::SensingConfig sensing_;
  dynamics::RelativeOptions options_;
  int first_target_;                    // its node
  TimeNs look_period_, member_period_;  // 0: none of this kind
  TimeNs exchange_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
  std::vector<Pinger> pingers_;  // [AUVs]
  acoustics::PingTotals totals_;
};

/// Why AUVs cannot ping with these sections; empty: they can.
/// @param sensing true sensing
std::optional<config::Violation> FindPingConflict(const AgentModel& model,
                                                  const dynamics::SensingConfig& sensing);

}  // namespace stg::agent
