// A medium access of your own: in every decision a random draw decides for each node if it sends.
// See docs/how_to/add_a_medium_access.md.

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "acoustic_channel/access/medium_access.hpp"
#include "acoustic_channel/channel/channel.hpp"
#include "auv_common/config/loader.hpp"
#include "auv_common/numbers/random.hpp"
#include "auv_common/plugin.hpp"

namespace {

using namespace stg;
using namespace stg::acoustics;

struct LotteryOptions {
  double mean_s = 0.5;  // between two packets
};

void Describe(LotteryOptions* o, config::Table* t) {
  t->Add("mean_s", &o->mean_s, config::Positive(1e4), "s", "mean time between two packets");
}

class Lottery : public MediumAccess {
 public:
  Lottery(const LotteryOptions& options, const RunConfig& run)
      : period_(run.decision_period()), probability_(run.decision_dt_s() / options.mean_s) {}

  void Reset(std::uint64_t seed, std::uint32_t episode) override {
    seed_ = seed;
    episode_ = episode;
  }

  TimeNs Next(int node, TimeNs from, const Attempt& /*attempt*/) const override {
    TimeNs decision = (from + period_ - 1) / period_;
    while (!Wins(node, decision)) ++decision;
    return decision * period_;
  }

 private:
  bool Wins(int node, TimeNs decision) const {
    Random random(seed_, Stream::kMediumAccess, episode_, static_cast<std::uint32_t>(decision),
                  static_cast<std::uint32_t>(node));
    return random.Uniform() < probability_;
  }

  TimeNs period_;
  double probability_;
  std::uint64_t seed_ = 0;
  std::uint32_t episode_ = 0;
};

std::unique_ptr<MediumAccess> MakeLottery(const LotteryOptions& options, const ChannelConfig&,
                                          const RunConfig& run) {
  return std::make_unique<Lottery>(options, run);
}

}  // namespace

// As a shared library, which any program loads: see docs/how_to/load_a_plugin.md.
STG_PLUGIN { MediumAccesses().Add("lottery", MakeLottery); }

int main() {
  stg_plugin_register();

  NetworkConfig network;
  network.run.agents = 2;
  // On average, a node sends in every fifth decision.
  config::Override(&network,
                   {"channel.model=range", "channel.access=lottery", "channel.lottery.mean_s=0.5"});
  const TimeNs period = network.run.decision_period();
  constexpr int kDecisions = 20000;

  const auto channel = MakeChannel(network.channel, network.run);
  Turns turns(network.channel, network.run);  // for a node whose modem is in another process
  channel->Reset(/*seed=*/1, /*episode=*/0);
  turns.Reset(1, 0);
  const std::uint8_t bytes[] = {1, 2, 3};
  const std::vector<Vec3<double>> nowhere(2);
  std::vector<Reception> received;
  double wait_s = 0.0;
  bool agree = true;
  for (int k = 0; k < kDecisions; ++k) {
    const TimeNs t = k * period;
    Transmission packet;
    packet.stamp = packet.generation = t;
    packet.payload = {bytes, sizeof(bytes)};
    // A packet is offered in every decision. It replaces the waiting one until the node's turn.
    channel->Step(t, static_cast<std::uint32_t>(k), nowhere, nowhere, {packet});
    const std::size_t before = received.size();
    channel->Deliver(1, t + period, &received);
    agree = agree && turns.Due(0, t) == (received.size() > before);
  }
  for (const Reception& r : received) wait_s += Seconds(r.transmit - r.generation);

  const double share = static_cast<double>(received.size()) / kDecisions;
  std::printf("sent in %.3f of the decisions, after %.3f s on average\n", share, wait_s);
  const double error = std::sqrt(0.2 * 0.8 / kDecisions);  // standard deviation of a share of 0.2
  return agree && std::abs(share - 0.2) < 4.0 * error && wait_s == 0.0 ? 0 : 1;
}
