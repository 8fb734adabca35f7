#pragma once

#include <memory>

#include "acoustic_channel/access/contention_config.hpp"
#include "acoustic_channel/access/medium_access.hpp"

namespace stg::acoustics {

/// Pure ALOHA (N. Abramson 1970): a packet leaves at once; throughput G exp(-2 G) at load G. With a
/// mean rest, a modem stays silent for an exponential time after a transmission; otherwise a modem
/// that always has a packet to send would receive none.
class Aloha : public MediumAccess {
 public:
  explicit Aloha(const ContentionConfig& config) : config_(config) {}
  void Reset(std::uint64_t seed, std::uint32_t episode) override;
  TimeNs Next(int node, TimeNs from, const Attempt& attempt) const override;
  bool adapts() const override { return config_.rest_s > 0.0; }

 protected:
  /// Earliest start after the rest.
  TimeNs Rested(int node, TimeNs from, const Attempt& attempt) const;

  ContentionConfig config_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
};

std::unique_ptr<MediumAccess> MakeAloha(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics
