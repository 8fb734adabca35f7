#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// The pings by which AUVs range each other and the stations (localization.ranges.by), and their
/// targets (sensing.ranging). Each target that is pinged carries a transponder, which is a node of
/// the network, after all others, and only answers. An AUV asks its modem for a ping. The request
/// waits for the AUV's turn on the water, leaves before its packet, and may be lost. What the
/// sensor's keys say of reach, chance and error of a look holds for the transponders: one that is
/// too far off, or misses the look, stays silent.
///
/// Use, in every episode: Reset; then for every decision Ask, the Step of the channel, and Take
/// after each Deliver. It observes the channel, to learn what becomes of the pings.
class AuvPings : public acoustics::PacketObserver {
 public:
  /// @param sensing as it truly is
  AuvPings(const AgentModel& model, const dynamics::SensingConfig& sensing);

  void Reset(std::uint64_t seed, std::uint32_t episode);
  /// Asks the AUVs' modems for what is due at decision `step`.
  /// @param p_W positions of all nodes, as `water` takes them
  void Ask(TimeNs t, std::uint32_t step, const std::vector<Vec3<double>>& p_W,
           acoustics::Channel* water);
  /// Adds answers that came to AUV `receiver` by `until`, each once, in order among the receptions
  /// from `first` on.
  void Take(int receiver, TimeNs until, std::size_t first, std::vector<acoustics::Reception>* out);
  const acoustics::PingTotals& totals() const { return totals_; }

  void OnSent(const acoustics::PacketInfo& packet) override;
  void OnPing(const acoustics::PingResult& ping) override;

 private:
  struct Pinger {
    bool look_due = false, member_due = false;  ///< a time has come that it has not asked at
    int last_member = -1;
    bool waits = false;                ///< a request has not left yet
    TimeNs sent = -1;                  ///< its last request left; -1: none did that has no answer
    double error = 0.0;                ///< of the range that it asks for, in standard deviations
    std::uint32_t asked = 0, tag = 0;  ///< how many, and that of the newest one
    bool answered = false;             ///< the next one means something
    acoustics::Reception answer;
  };
  int TargetOf(int auv) const;
  int NextMember(int auv) const;
  /// Of a target: its node, or kToNobody where the transponder stays silent.
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

/// Why AUVs cannot ping as the sections say; nothing: they can.
/// @param sensing as it truly is
std::optional<config::Violation> FindPingConflict(const AgentModel& model,
                                                  const dynamics::SensingConfig& sensing);

}  // namespace stg::agent
