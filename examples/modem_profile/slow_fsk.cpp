// A modem of your own: noncoherent FSK of any bit rate. The slower it sends, the farther it is
// heard. See docs/how_to/in_this_repository.md.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "acoustic_channel/channel/channel.hpp"
#include "acoustic_channel/modem/modem_profile.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/plugin.hpp"

namespace {

using namespace stg;
using namespace stg::acoustics;

struct SlowFskOptions {
  double bit_rate_bps = 100.0;
  double source_level_db = 170.0;
};

void Describe(SlowFskOptions* o, config::Table* t) {
  t->Add("bit_rate_bps", &o->bit_rate_bps, config::Within(1, 4000), "bit/s",
         "bits of a packet in a second");
  t->Add("source_level_db", &o->source_level_db, config::Within(100, 220), "dB re 1 uPa at 1 m",
         "source level");
}

std::unique_ptr<ModemProfile> MakeSlowFsk(const SlowFskOptions& options) {
  ModemProfile p;
  p.name = p.waveform = "slow_fsk";
  p.centre_khz = 20.0;
  p.bandwidth_khz = 4.0;
  p.source_level_db = options.source_level_db;
  p.preamble_s = 0.1;
  p.frame_bytes = 32;
  p.frame_s = 8.0 * static_cast<double>(p.frame_bytes) / options.bit_rate_bps;
  p.acquisition_db = -10.0;
  p.implementation_db = 3.0;
  p.errors.kind = ErrorCurve::Kind::kNoncoherentFsk;
  // The energy of a bit is above the noise of the band by the ratio of bandwidth and bit rate.
  p.spreading_db = 10.0 * std::log10(1e3 * p.bandwidth_khz / options.bit_rate_bps);
  p.errors.processing_gain_db = p.spreading_db;
  p.turnaround_s = 0.1;
  p.transmit_w = 20.0;
  p.receive_w = 0.3;
  p.idle_w = 0.05;
  return std::make_unique<ModemProfile>(p);
}

/// How many of 100 packets arrive over 8 km at a bit rate.
int Arrive(const std::string& bit_rate_bps) {
  NetworkConfig network;
  network.run.agents = 2;
  config::Override(&network, {"channel.model=physical", "channel.physical.modem.profile=slow_fsk",
                              "channel.physical.modem.slow_fsk.bit_rate_bps=" + bit_rate_bps});
  const auto channel = MakeChannel(network.channel, network.run);
  channel->Reset(/*seed=*/1, /*episode=*/0);
  const std::uint8_t bytes[32] = {1, 2, 3};
  const std::vector<Vec3<double>> at{{0.0, 0.0, -10.0}, {8000.0, 0.0, -10.0}}, still(2);
  std::vector<Reception> received;
  const TimeNs period = network.run.decision_period();
  for (int k = 0; k < 30000; ++k) {
    const TimeNs t = k * period;
    std::vector<Transmission> offered;
    if (k % 300 == 0) {
      offered.emplace_back();
      offered.back().stamp = offered.back().generation = t;
      offered.back().payload = {bytes, sizeof(bytes)};
    }
    channel->Step(t, static_cast<std::uint32_t>(k), at, still, offered);
    channel->Deliver(1, t + period, &received);
  }
  return static_cast<int>(received.size());
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { ModemProfiles().Add("slow_fsk", MakeSlowFsk); }

int main() {
  stg_plugin_register();

  const int slow = Arrive("40"), fast = Arrive("1000");
  std::printf("of 100 packets over 8 km, %d arrive at 40 bit/s and %d at 1000 bit/s\n", slow, fast);
  return slow > 90 && fast < 10 ? 0 : 1;
}
