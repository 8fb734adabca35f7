#pragma once

#include <memory>

#include "acoustic_channel/access/aloha.hpp"

namespace stg::acoustics {

/// Carrier sense, not persistent (L. Kleinrock and F. A. Tobagi 1975): as Aloha, but a modem
/// listens first. If it hears a carrier, it waits for a time uniform in (0, backoff], whose bound
/// doubles at each try up to 32 times the first. A carrier is heard only after its travel time; if
/// that is longer than a packet, listening has no benefit.
class Csma : public Aloha {
 public:
  explicit Csma(const ContentionConfig& config) : Aloha(config) {}
  TimeNs Next(int node, TimeNs from, const Attempt& attempt) const override;
  bool listens() const override { return true; }
  bool adapts() const override { return true; }
};

std::unique_ptr<MediumAccess> MakeCsma(const ChannelConfig& config, const RunConfig& run);

}  // namespace stg::acoustics
