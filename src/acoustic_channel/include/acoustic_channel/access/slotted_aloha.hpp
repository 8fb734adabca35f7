#pragma once

#include <memory>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/access/slots_config.hpp"

namespace stg::acoustics {

/// Slotted ALOHA (L. G. Roberts 1972): slots of Tdma without owners. A waiting packet leaves at the
/// start of a slot with probability q. The throughput is G exp(-G) at load G if the guard covers
/// the differences between the paths. Without a guard it falls towards the throughput of pure
/// ALOHA.
class SlottedAloha : public MediumAccess {
 public:
  explicit SlottedAloha(const SlotsConfig& config);
  void Reset(std::uint64_t seed, std::uint32_t episode) override;
  TimeNs Next(int node, TimeNs from, const Attempt& attempt) const override;
  std::optional<config::Violation> FindConflict(const PacketTime& packet) const override;

 private:
  SlotsConfig config_;
  TimeNs slot_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
};

std::unique_ptr<MediumAccess> MakeSlottedAloha(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics
