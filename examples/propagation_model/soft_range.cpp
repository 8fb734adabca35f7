// A propagation model of your own: the loss of packets grows gradually around a range. See
// docs/how_to/add_a_propagation_model.md.

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "acoustic_channel/models/independent_model.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"

namespace {

using namespace stg;
using namespace stg::acoustics;

struct SoftRangeOptions {
  double steepness = 8.0;
  double sound_speed_mps = 1500.0;
  double freshness_s = 2.0;
};

void Describe(SoftRangeOptions* o, config::Table* t) {
  t->Add("steepness", &o->steepness, config::Positive(1e3), "-",
         "how steeply the probability of arrival falls around the range");
  t->Add("sound_speed_mps", &o->sound_speed_mps, config::Positive(1e5), "m/s",
         "propagation speed of packets");
  t->Add("freshness_s", &o->freshness_s, config::Positive(1e5), "s",
         "decay time of link quality with the age of information");
}

class SoftRange {
 public:
  SoftRange(const SoftRangeOptions& options, const ChannelConfig& config)
      : options_(options), range_m_(config.range_m) {}

  template <class T>
  T DelayS(const T& d) const {
    return d / T(options_.sound_speed_mps);
  }
  template <class T>
  LinkValues<T> At(const T& d, const T& age_s) const {
    const T arrives = T(1.0) / (T(1.0) + Exp((d / T(range_m_) - T(1.0)) * T(options_.steepness)));
    return {T(1.0) - arrives, arrives * Exp(-age_s / T(options_.freshness_s))};
  }
  bool Reaches(double d) const { return d < 3.0 * range_m_; }
  bool ages() const { return true; }
  double freshness_s() const { return options_.freshness_s; }

 private:
  SoftRangeOptions options_;
  double range_m_;
};

/// Share of the packets of node 0 that node 1 receives at distance d [m].
double ShareAt(double d, const NetworkConfig& network) {
  constexpr int kPackets = 4000;
  const auto channel = MakeChannel(network.channel, network.run);
  channel->Reset(/*seed=*/1, /*episode=*/0);
  const std::uint8_t bytes[] = {1, 2, 3};
  std::vector<Reception> received;
  for (int k = 0; k < kPackets; ++k) {
    const TimeNs t = k * network.run.decision_period();
    Transmission packet;
    packet.stamp = packet.generation = t;
    packet.payload = {bytes, sizeof(bytes)};
    channel->Step(t, static_cast<std::uint32_t>(k), {{}, {d, 0.0, 0.0}}, {{}, {}}, {packet});
    channel->Deliver(1, t + network.run.decision_period(), &received);
  }
  return static_cast<double>(received.size()) / kPackets;
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN {
  PropagationModels().Add("soft_range", MakeIndependentModel<SoftRange, SoftRangeOptions>);
}

int main() {
  stg_plugin_register();

  NetworkConfig network;
  network.run.agents = 2;
  config::Override(&network, {"channel.model=soft_range", "channel.soft_range.steepness=6"});
  network.channel.range_m = 100.0;
  network.channel.periodic.transmit_period_s =
      network.run.decision_dt_s();  // a packet in every decision

  // Half of the packets arrive at the range itself. An agent's estimate of the link agrees.
  const double near = ShareAt(60.0, network), at = ShareAt(100.0, network);
  const double quality = MakeLinkEstimator(network.channel, 2)->Quality(100.0, 0.0);
  std::printf("arrived: %.3f at 60 m, %.3f at 100 m, %.3f at 301 m; quality at 100 m %.3f\n", near,
              at, ShareAt(301.0, network), quality);
  const double expected = 1.0 / (1.0 + std::exp(-0.4 * 6.0));
  const bool good = std::abs(near - expected) < 0.02 && std::abs(at - 0.5) < 0.04 &&
                    ShareAt(301.0, network) == 0.0 && std::abs(quality - 0.5) < 1e-12;
  return good ? 0 : 1;
}
