#include <array>
#include <tuple>

#include "acoustic_channel/offline/simulation.hpp"
#include "auv_common/numbers/random.hpp"
#include "modem_fixture.hpp"

/// Messages of emulated modems have the same physics as packets of `simulate`.
namespace stg::acoustics {
namespace {

/// Three senders in a line, 900 m apart. Some packets are lost to range, to fading and to each
/// other.
constexpr std::array<double, 3> kPlaces{0.0, 900.0, 1800.0};
constexpr std::size_t kBytes = 32;
constexpr int kNodes = static_cast<int>(kPlaces.size());

ChannelConfig Water() {
  ChannelConfig config;
  config.model = "physical";
  config.access = "aloha";
  config.physical.modem.queue = QueuePolicy::kFifo;
  config.physical.modem.profile = "evologics_s2c";
  // The site is so loud that a neighbour is just understood. Bursts come in addition.
  config.physical.noise.site_db = 92.0;
  config.physical.noise.burst_every_s = 20.0;
  return config;
}

/// Random times at which each node sends. A message leaves before the next one comes.
std::vector<std::vector<double>> Times(int messages, std::uint64_t seed) {
  std::vector<std::vector<double>> times(kNodes);
  for (int node = 0; node < kNodes; ++node) {
    double t_s = 1.0;
    for (int k = 0; k < messages; ++k) {
      Random random(seed, Stream::kClock, 0, static_cast<std::uint32_t>(k),
                    static_cast<std::uint32_t>(node));
      t_s += 1.0 + 12.0 * random.Uniform();
      times[static_cast<std::size_t>(node)].push_back(1e-6 * std::round(1e6 * t_s));
    }
  }
  return times;
}

/// Hosts of emulated modems write AT*SENDIM at these times.
void Emulate(const std::vector<std::vector<double>>& times, std::uint64_t seed, Log* log) {
  RunConfig run;
  run.agents = kNodes;
  Hosts hosts;
  ModemWater water(Water(), run, &hosts);
  hosts.water = &water;
  for (int i = 0; i < kNodes; ++i) {
    s2c::ModemOptions options = ModemBench::NetOptions();
    options.address = i + 1;
    options.defer = false;
    water.Attach(i, options.address, [&](ModemSurroundings* world) {
      return std::make_unique<s2c::S2cModem>(options, world);
    });
  }
  water.Observe(log);
  water.Reset(seed, 0);
  std::vector<std::tuple<TimeNs, int>> sends;
  for (int i = 0; i < kNodes; ++i) {
    water.Move(i, 0, {{kPlaces[static_cast<std::size_t>(i)], 0.0, -20.0}, {0.0, 0.0, 0.0}});
    water.Connect(i, 0);
    for (const double t_s : times[static_cast<std::size_t>(i)]) sends.emplace_back(Ns(t_s), i);
  }
  std::sort(sends.begin(), sends.end());
  const std::string message = "AT*SENDIM,32,255,noack," + std::string(kBytes, 'x') + "\n";
  for (const auto& [t, node] : sends) {
    water.Read(node, t, {reinterpret_cast<const std::uint8_t*>(message.data()), message.size()});
  }
  water.Advance(std::get<0>(sends.back()) + 10 * kSecond);
  EXPECT_EQ(hosts.all[0].find("BUSY"), std::string::npos);
}

/// The same traffic runs in `simulate`.
void Simulate(const std::vector<std::vector<double>>& times, std::uint64_t seed, Log* log) {
  SimulationFile file;
  file.seed = seed;
  file.step_s = 1.0;
  file.channel = Water();
  for (int i = 0; i < kNodes; ++i) {
    SimulatedNode node;
    node.id = i;
    node.track = Track::Line({kPlaces[static_cast<std::size_t>(i)], 0.0, -20.0}, {0.0, 0.0, 0.0});
    file.nodes.push_back(node);
    TrafficSpec flow;
    flow.source = i;
    flow.kind = TrafficSpec::Kind::kAt;
    flow.times_s = times[static_cast<std::size_t>(i)];
    flow.bytes = kBytes;
    file.traffic.push_back(flow);
    file.duration_s = std::max(file.duration_s, flow.times_s.back() + 10.0);
  }
  Simulation simulation(file, log);
  while (simulation.Step()) {
  }
}

double Share(const Log& log) {
  const auto delivered = std::count_if(log.fates.begin(), log.fates.end(), [](const Log::Fate& f) {
    return f.fate.reason == DropReason::kNone;
  });
  return static_cast<double>(delivered) / static_cast<double>(log.fates.size());
}

double MeanDelay(const Log& log) {
  double sum = 0.0;
  int count = 0;
  for (const Log::Fate& f : log.fates) {
    if (f.fate.reason != DropReason::kNone) continue;
    sum += Seconds(f.fate.arrival - f.packet.offered);
    ++count;
  }
  return sum / count;
}

TEST(SamePhysics, WithOneSeedEveryMessageHasTheFateOfItsPacket) {
  const auto times = Times(400, 1);
  Log emulated, simulated;
  Emulate(times, 5, &emulated);
  Simulate(times, 5, &simulated);
  ASSERT_EQ(emulated.fates.size(), 3u * 400u * 2u);
  using Row = std::tuple<int, std::uint32_t, int, DropReason, TimeNs, TimeNs>;
  const auto rows = [](const Log& log) {
    std::vector<Row> all;
    for (const Log::Fate& f : log.fates) {
      all.emplace_back(f.packet.source, f.packet.sequence, f.fate.receiver, f.fate.reason,
                       f.packet.transmit, f.fate.arrival);
    }
    std::sort(all.begin(), all.end());
    return all;
  };
  EXPECT_EQ(rows(emulated), rows(simulated));
  // Packets must be lost for several reasons. Otherwise the test would show little.
  std::map<DropReason, int> reasons;
  for (const Log::Fate& f : emulated.fates) ++reasons[f.fate.reason];
  EXPECT_GE(reasons.size(), 4u);
  EXPECT_GT(Share(emulated), 0.3);
  EXPECT_LT(Share(emulated), 0.9);
}

TEST(SamePhysics, WithOtherSeedsTwentyThousandMessagesAgreeWithinAHundredth) {
  Log emulated, simulated;
  Emulate(Times(6700, 1), 5, &emulated);
  Simulate(Times(6700, 2), 6, &simulated);
  EXPECT_NEAR(Share(emulated), Share(simulated), 0.01);
  EXPECT_NEAR(MeanDelay(emulated), MeanDelay(simulated), 0.01 * MeanDelay(simulated));
  RecordProperty("share_of_modems", std::to_string(Share(emulated)));
  RecordProperty("share_of_simulate", std::to_string(Share(simulated)));
}

}  // namespace
}  // namespace stg::acoustics
