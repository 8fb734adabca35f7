#include "acoustic_channel/water/absorption.hpp"
#include "simulate_fixture.hpp"

/// What happens to single packets, and what the program tells its user.
namespace stg::acoustics {
namespace {

/// With this modem 32 bytes take 0.5035 s. Sound travels at 1500 m/s.
std::string Head(const std::string& more = "", double duration_s = 20.0) {
  return "duration_s: " + std::to_string(duration_s) +
         "\nseed: 1\nchannel:\n  model: physical\n  access: aloha\n"
         "  physical:\n    modem: {profile: evologics_s2c}\n" +
         kSteadyWater + more;
}

std::string At(int source, const std::string& times, const std::string& more = "") {
  return "  - {source: " + std::to_string(source) + ", kind: at, times_s: [" + times +
         "], bytes: 32" + more + "}\n";
}

TEST_F(Simulate, APacketArrivesAfterItsWayAndItsAirtime) {
  const Result r = Run(Head() + "nodes:\n" + NodeAt(3, 0, 0) + NodeAt(7, 900, 1200) + "traffic:\n" +
                       At(3, "1.0"));
  ASSERT_EQ(r.code, 0) << r.err;
  ASSERT_EQ(r.rows.size(), 2u);
  EXPECT_EQ(r.Cell(1, "source"), "3");
  EXPECT_EQ(r.Cell(1, "destination"), "7");
  EXPECT_EQ(r.Cell(1, "addressed"), "all");
  EXPECT_EQ(r.Cell(1, "bytes"), "32");
  EXPECT_EQ(r.Cell(1, "fate"), "delivered");
  EXPECT_EQ(r.Cell(1, "transmit_s"), "1.000000000");
  EXPECT_NEAR(r.Number(1, "travel_time_s"), 1.0, 1e-9);
  EXPECT_NEAR(r.Number(1, "arrival_s"), 1.0 + 1.0 + 0.5035, 1e-9);
  EXPECT_NEAR(r.Number(1, "distance_m"), 1500.0, 1e-9);
  EXPECT_NEAR(r.Number(1, "received_level_db"),
              184.0 - 15.0 * std::log10(1500.0) - 1.5 * ThorpAbsorption(26.0), 1e-3);
  EXPECT_EQ(r.json["offered"], 1);
  EXPECT_EQ(r.json["transmitted"], 1);
  EXPECT_EQ(r.json["delivered"], 1);
  EXPECT_EQ(r.json["delivery_ratio"], 1.0);
  EXPECT_NEAR(r.Throughput(7), 0.5035 / 20.0, 1e-9);
  EXPECT_GT(r.json["energy_j"]["3"], r.json["energy_j"]["7"]);
}

TEST_F(Simulate, WhoSendsDoesNotHear) {
  // 150 m take 0.1 s. Each packet arrives while its receiver is sending.
  Result r = Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 150, 0) + "traffic:\n" +
                 At(0, "1.0") + At(1, "1.1"));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.Fate(0, 1), "half_duplex");
  EXPECT_EQ(r.Fate(1, 0), "half_duplex");
  EXPECT_EQ(r.json["drops"]["half_duplex"], 2);
  // A node that sends in the middle of a reception loses it.
  r = Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 150, 0) + "traffic:\n" + At(0, "1.0") +
          At(1, "1.5"));
  EXPECT_EQ(r.Fate(0, 1), "half_duplex");
  EXPECT_EQ(r.Fate(1, 0), "delivered");
  // Two packets cross in the water, as their senders are 1 s of sound apart.
  r = Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 1500, 0) + "traffic:\n" + At(0, "1.0") +
          At(1, "1.0"));
  EXPECT_EQ(r.Fate(0, 1), "delivered");
  EXPECT_EQ(r.Fate(1, 0), "delivered");
}

TEST_F(Simulate, PacketsCollideAtOneReceiverAndNotAtAnother) {
  const Result r =
      Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 3000, 0) + NodeAt(2, 1500, 0) +
          NodeAt(3, 300, 0) + "traffic:\n" + At(0, "1.0") + At(1, "1.0"));
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.Fate(0, 2), "collision");
  EXPECT_EQ(r.Fate(1, 2), "collision");
  EXPECT_EQ(r.Fate(0, 3), "delivered");
  EXPECT_EQ(r.Fate(1, 3), "delivered");
}

TEST_F(Simulate, EveryPacketAndReceiverIsAccountedFor) {
  std::string text = Head("", 300.0) + "nodes:\n";
  for (int i = 0; i < 6; ++i) text += NodeAt(i, 400.0 * i, 300.0 * (i % 2));
  text += "traffic:\n";
  for (int i = 0; i < 6; ++i) {
    text += "  - {source: " + std::to_string(i) + ", kind: poisson, rate_hz: 0.7, bytes: 20}\n";
  }
  text += "  - {source: 2, destination: 5, kind: poisson, rate_hz: 0.2, bytes: 32}\n";
  for (const char* model : {"physical", "range", "extended"}) {
    std::string of_model = text;
    if (std::string(model) != "physical") {
      const std::size_t from = of_model.find("  physical:"), to = of_model.find("nodes:");
      of_model.replace(from, to - from,
                       std::string(model) == "range"
                           ? "  range_m: 900.0\n"
                           : "  extended: {max_range_m: 900.0, loss_distance_m: 800.0}\n");
      of_model.replace(of_model.find("model: physical"), 15, std::string("model: ") + model);
    }
    const Result r = Run(of_model);
    ASSERT_EQ(r.code, 0) << r.err;
    std::size_t dropped = 0, delivered = 0;
    for (std::size_t i = 1; i < r.rows.size(); ++i) {
      (r.Cell(i, "fate") == "delivered" ? delivered : dropped) += 1;
    }
    EXPECT_EQ(r.json["delivered"], delivered);
    std::size_t counted = 0;
    for (const auto& count : r.json["drops"]) counted += count.get<std::size_t>();
    EXPECT_EQ(counted, dropped);
    EXPECT_GT(delivered, 500u) << model;
    EXPECT_GT(dropped, 500u) << model;
    std::size_t received = 0, on_links = 0;
    for (const auto& receiver : r.json["receivers"]) {
      received += receiver["delivered"].get<std::size_t>();
    }
    for (const auto& link : r.json["links"]) on_links += link["delivered"].get<std::size_t>();
    EXPECT_EQ(received, delivered);
    EXPECT_EQ(on_links, delivered);
  }
}

TEST_F(Simulate, TheSameFileGivesTheSameBytes) {
  const std::string text = Head("", 200.0) + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 900, 0) +
                           NodeAt(2, 0, 900) +
                           "traffic:\n"
                           "  - {source: 0, kind: poisson, rate_hz: 0.5, bytes: 32}\n"
                           "  - {source: 1, kind: poisson, rate_hz: 0.5, bytes: 32}\n";
  const std::string fading = "propagation: {shadowing_db: 8.0, rician_k: 1.0}";
  std::string faded = text;
  faded.replace(faded.find("propagation:"), fading.size() + 1, fading + "\n#");
  const Result first = Run(faded), second = Run(faded);
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(first.out, second.out);
  EXPECT_EQ(first.rows, second.rows);
  std::string other = faded;
  other.replace(other.find("seed: 1"), 7, "seed: 2");
  EXPECT_NE(Run(other).rows, first.rows);
}

TEST_F(Simulate, NodesMoveOnTracksJoinAndLeave) {
  Write("t,x,y,z\n0,100,0,-20\n500,1100,0,-20\n", "way.csv");
  const Result r = Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + "  - {id: 1, track: way.csv}\n" +
                       "  - {id: 2, position_m: [0, 50, -20], joins_s: 4.0, leaves_s: 8.0}\n" +
                       "traffic:\n" + At(0, "2.0, 5.0, 9.0"));
  ASSERT_EQ(r.code, 0) << r.err;
  for (int k = 0; k < 3; ++k) EXPECT_EQ(r.Fate(0, 1, k), "delivered") << k;
  EXPECT_EQ(r.Fate(0, 2, 0), "left");
  EXPECT_EQ(r.Fate(0, 2, 1), "delivered");
  EXPECT_EQ(r.Fate(0, 2, 2), "left");
  for (std::size_t i = 1; i < r.rows.size(); ++i) {
    if (r.Cell(i, "destination") != "1") continue;
    EXPECT_NEAR(r.Number(i, "distance_m"), 100.0 + 2.0 * r.Number(i, "transmit_s"), 1e-3);
  }
}

TEST_F(Simulate, AnAddressedPacketIsForOneOnly) {
  const Result r = Run(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + NodeAt(2, 0, 90) +
                       "traffic:\n" + At(0, "1.0", ", destination: 2"));
  ASSERT_EQ(r.code, 0) << r.err;
  ASSERT_EQ(r.rows.size(), 2u);
  EXPECT_EQ(r.Cell(1, "destination"), "2");
  EXPECT_EQ(r.json["delivery_ratio"], 1.0);
}

TEST_F(Simulate, BadFilesAreRefusedWithFileLineAndKey) {
  const std::string good =
      Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n" + At(0, "1.0");
  ASSERT_EQ(Run(good).code, 0);
  const struct {
    std::string from, to, message;
  } cases[] = {
      {"duration_s: 20", "duration: 20", ":1: duration: unknown key, did you mean duration_s?"},
      {"duration_s: 20.000000", "duration_s: -1", ":1: duration_s: -1.0 is out of range"},
      {"seed: 1", "seed: one", ":2: seed: expected an integer"},
      {"access: aloha", "access: alhoa", ":5: channel.access: expected one of"},
      {"access: aloha", "access: aloha\n  slots: {length_s: 2.0}",
       ":6: channel.slots.length_s: belongs to the medium access 'tdma' or 'slotted_aloha'; this"},
      {"profile: evologics_s2c", "profil: x", "channel.physical.modem.profil: unknown key"},
      {"shadowing_db: 0.0", "shadowing_db: .nan", "channel.physical.propagation.shadowing_db: "},
      {"id: 1,", "id: 0,", "nodes[1].id: 0 is also the id of nodes[0]"},
      {"id: 1,", "di: 1,", "nodes[1].di: unknown key"},
      {"id: 1, position_m: ", "id: 1, velocity_mps: ", "nodes[1].position_m: missing key"},
      {"id: 1, position_m", "id: 1, track: none.csv, position_m",
       "nodes[1].position_m: cannot be combined with a track"},
      {"source: 0", "source: 5", "traffic[0].source: no node has the id 5"},
      {"source: 0", "source: 0, destination: 0",
       "traffic[0].destination: must differ from the source"},
      {"kind: at", "kind: often", "traffic[0].kind: expected one of"},
      {"kind: at", "kind: poisson", "traffic[0].rate_hz: missing key"},
      {"kind: at", "kind: at, rate_hz: 1.0", "traffic[0].rate_hz: belongs to another kind"},
      {"[1.0]", "[]", "traffic[0].times_s: expected a list that is not empty"},
      {"[1.0]", "[-1.0]", "traffic[0].times_s: -1.0 is out of range"},
      {"[1.0]", "[1.0, 20.0]", "traffic[0].times_s: a time is not before the end, duration_s"},
      {"kind: at, times_s: [1.0]", "kind: periodic, period_s: 1.0, offset_s: 30.0",
       "traffic[0].offset_s: the first packet is not before the end, duration_s"},
      {"access: aloha", "access: aloha\n  range_m: 9.0",
       ":6: channel.range_m: belongs to the propagation model 'range'; this"},
      {"profile: evologics_s2c", "profile: ideal",
       "ideal modems receive each packet, whatever its level and the noise"},
      {"bytes: 32", "bytes: 0", "traffic[0].bytes: 0 is out of range"},
      {"bytes: 32", "bytes: 65",
       "traffic[0].bytes: more than the longest packet of this channel, 64"},
      {"traffic:", "trafic:", "trafic: unknown key"},
  };
  for (const auto& c : cases) {
    std::string text = good;
    ASSERT_NE(text.find(c.from), std::string::npos) << c.from;
    text.replace(text.find(c.from), c.from.size(), c.to);
    const Result r = Run(text);
    EXPECT_EQ(r.code, 2) << c.to;
    EXPECT_NE(r.err.find("network.yaml:"), std::string::npos) << r.err;
    EXPECT_NE(r.err.find(c.message), std::string::npos) << r.err << "wanted: " << c.message;
    EXPECT_TRUE(r.out.empty()) << r.out;
  }
}

TEST_F(Simulate, NodesWithModemsStayInTheWaterWhileTheyTakePart) {
  Write("t,x,y,z\n0,100,0,-20\n10,100,0,52\n15,100,0,-20\n", "leap.csv");
  const auto with = [](const std::string& node) {
    return Head() + "nodes:\n" + NodeAt(0, 0, 0) + "  - {id: 1, " + node + "}\n" + "traffic:\n" +
           At(0, "1.0");
  };
  for (const auto& [node, message] : std::vector<std::pair<std::string, std::string>>{
           {"position_m: [90, 0, 52]", "nodes[1].position_m: at 0.000000 s the node is 52.0"},
           {"position_m: [90, 0, -1e5]", "m deep, where the water has"},
           {"position_m: [90, 0, -20], velocity_mps: [0, 0, 2]", "at 20.000000 s the node is 20.0"},
           {"track: leap.csv", "nodes[1].track: at 10.000000 s the node is 52.0"}}) {
    const Result r = Run(with(node));
    EXPECT_EQ(r.code, 2) << node;
    EXPECT_NE(r.err.find(message), std::string::npos) << r.err;
  }
  EXPECT_EQ(Run(with("track: leap.csv, leaves_s: 2.0")).code, 0) << "it leaves before";
}

TEST_F(Simulate, ListsOfTimesMayBeLong) {
  const auto file = [](int count) {
    std::string times;
    for (int k = 0; k < count; ++k) {
      times += (k == 0 ? "" : ",") + std::to_string(k % 10) + ".5";
    }
    return Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n" + At(0, times);
  };
  const Result r = Run(file(50000), "--quiet --summary-only");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.json["offered"], 50000);
  EXPECT_EQ(r.json["drops"]["queue"], 50000 - r.json["transmitted"].get<int>());
  const Result beyond = Run(file(290000), "--quiet --summary-only");
  EXPECT_EQ(beyond.code, 2);
  EXPECT_NE(beyond.err.find("larger than"), std::string::npos) << beyond.err;
}

TEST_F(Simulate, ASlotShorterThanAPacketIsAnError) {
  std::string text = Head("  slots: {length_s: 0.5, guard_s: 0.1}\n") + "nodes:\n" +
                     NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n" + At(0, "1.0");
  text.replace(text.find("aloha"), 5, "tdma");
  const Result r = Run(text);
  EXPECT_EQ(r.code, 2);
  EXPECT_NE(r.err.find("channel.slots.length_s"), std::string::npos) << r.err;
  EXPECT_NE(r.err.find("network.yaml:"), std::string::npos) << r.err;
}

TEST_F(Simulate, ShippedNetworksRun) {
  int networks = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STG_NETWORKS)) {
    if (entry.path().extension() != ".yaml") continue;
    ++networks;
    const Result r = Command("'" + entry.path().string() + "' --out '" + folder_ + "/out' --quiet");
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_GT(r.json["delivery_ratio"], 0.3);
  }
  EXPECT_GT(networks, 0);
}

TEST_F(Simulate, CommandLine) {
  const Result help = Command("--help");
  EXPECT_EQ(help.code, 0);
  for (const char* option : {"--out", "--quiet", "--summary-only", "file"}) {
    EXPECT_NE(help.out.find(option), std::string::npos) << option;
  }
  EXPECT_EQ(Command("").code, 2);
  EXPECT_EQ(Command("none.yaml").code, 2);
  const Result missing = Command("'" + folder_ + "/none.yaml' --out '" + folder_ + "/out'");
  EXPECT_EQ(missing.code, 2);
  EXPECT_NE(missing.err.find("none.yaml"), std::string::npos);
  const std::string good =
      Write(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n" + At(0, "1.0"));
  const Result nowhere = Command("'" + good + "' --out /proc/none");
  EXPECT_EQ(nowhere.code, 2);
  EXPECT_NE(nowhere.err.find("cannot be written"), std::string::npos) << nowhere.err;
  const Result talking = Command("'" + good + "' --out '" + folder_ + "/a/b'");
  EXPECT_EQ(talking.code, 0) << talking.err;
  EXPECT_NE(talking.out.find("offered 1 packets, transmitted 1, delivered 1 of 1 receptions"),
            std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(Read(folder_ + "/a/b/summary.json")), talking.json);
  EXPECT_EQ(Read(folder_ + "/a/b/simulation.yaml"), Read(good));
}

TEST_F(Simulate, TheFolderHoldsAllThatTheSimulationNeeds) {
  std::ofstream(folder_ + "/way.csv") << "t,x,y,z\n0,50,0,-10\n9,90,0,-10\n";
  const std::string file = Write(Head() + "nodes:\n" + NodeAt(0, 0, 0) +
                                 "  - {id: 1, track: way.csv}\ntraffic:\n" + At(0, "1.0"));
  const std::string first = folder_ + "/first", second = folder_ + "/second";
  ASSERT_EQ(Command("'" + file + "' --out '" + first + "'").code, 0);
  EXPECT_EQ(Read(first + "/way.csv"), Read(folder_ + "/way.csv"));
  ASSERT_EQ(Command("'" + first + "/simulation.yaml' --out '" + second + "'").code, 0);
  EXPECT_EQ(Read(first + "/packets.csv"), Read(second + "/packets.csv"));
}

TEST_F(Simulate, ASummaryAloneStandsBesideNoPacketsOfAnEarlierSimulation) {
  const std::string file =
      Write(Head() + "nodes:\n" + NodeAt(0, 0, 0) + NodeAt(1, 90, 0) + "traffic:\n" + At(0, "1.0"));
  const std::string folder = folder_ + "/out", arguments = "'" + file + "' --out '" + folder + "'";
  EXPECT_EQ(Command(arguments).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder + "/packets.csv"));
  EXPECT_EQ(Command(arguments + " --summary-only").code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder + "/packets.csv"));
}

}  // namespace
}  // namespace stg::acoustics
