#include "simulate_fixture.hpp"

/// Throughput and age of information of networks against their closed forms.
namespace stg::acoustics {
namespace {

/// The modem of these tests: 32 bytes take half a second.
constexpr double kAirtimeS = 0.1515 + 32 * 0.011;

std::string Sources(int senders, const std::string& kind) {
  std::string text = "traffic:\n";
  for (int i = 1; i <= senders; ++i) {
    text += "  - {source: " + std::to_string(i) + ", destination: 0, bytes: 32, " + kind + "}\n";
  }
  return text;
}

std::string Head(double duration_s, const std::string& access, const std::string& slots = "") {
  return "duration_s: " + std::to_string(duration_s) + "\nseed: 5\nstep_s: 10.0\nchannel:\n" +
         "  model: physical\n  access: " + access + "\n" +
         "  modem: {profile: evologics_s2c, packet_bytes: 32}\n" + slots + kSteadyWater;
}

std::string Poisson(double load, int senders) {
  return "kind: poisson, rate_hz: " + std::to_string(load / (senders * kAirtimeS));
}

class Throughput : public Simulate {
 protected:
  double Of(const std::string& access, int senders, double radius_m, double load, double packets,
            const std::string& slots = "") {
    const double duration_s = packets * kAirtimeS / load;
    const Result r = Run(Head(duration_s, access, slots) + Ring(senders, radius_m) +
                             Sources(senders, Poisson(load, senders)),
                         "--quiet --summary-only");
    EXPECT_EQ(r.code, 0) << r.err;
    return r.Throughput(0);
  }
};

/// Senders of which each keeps one packet while it sends another: M/D/1 with one place to wait.
/// Idle share p0, load N (1 - p0), and a packet meets no other when each other sender is idle as it
/// begins and does not begin until it ends. For N to infinity S = G exp(-2 G).
double FiniteAloha(double load, int senders) {
  const double rho = load / senders;
  const double idle = std::exp(-rho) / (std::exp(-rho) + rho);
  return senders * (1.0 - idle) * std::pow(idle * std::exp(-rho), senders - 1);
}

TEST_F(Throughput, TheFormulaForFewSendersBecomesThatForMany) {
  for (double load : {0.1, 0.5, 1.0, 2.0}) {
    EXPECT_NEAR(FiniteAloha(load, 100000) / (load * std::exp(-2.0 * load)), 1.0, 1e-4);
  }
}

TEST_F(Throughput, PureAlohaOfFewSenders) {
  for (const auto& [load, packets] : {std::pair{0.1, 3e4}, {0.5, 6e4}, {1.0, 2e5}, {2.0, 4e5}}) {
    EXPECT_NEAR(Of("aloha", 12, 750.0, load, packets) / FiniteAloha(load, 12), 1.0, 0.02) << load;
  }
}

TEST_F(Throughput, PureAlohaOfManySenders) {
  EXPECT_NEAR(Of("aloha", 150, 750.0, 0.1, 1e4), 0.0819, 0.02 * 0.0819);
  EXPECT_NEAR(Of("aloha", 150, 750.0, 0.5, 3e4), 0.1839, 0.02 * 0.1839);
}

/// A sender sends in a slot when anything came in the one before: q = 1 - exp(-G/N).
TEST_F(Throughput, SlottedAloha) {
  const std::string slots = "  slots: {length_s: 0.504, guard_s: 0.0005}\n";
  const double slot_s = 0.504;
  for (const auto& [load, packets] : {std::pair{0.1, 2e4}, {0.5, 4e4}, {1.0, 6e4}, {2.0, 1e5}}) {
    const int senders = 40;
    const double arrivals = load * slot_s / kAirtimeS / senders;  // of a sender in a slot
    const double q = 1.0 - std::exp(-arrivals);
    const double expected = senders * q * std::pow(1.0 - q, senders - 1) * kAirtimeS / slot_s;
    EXPECT_NEAR(Of("slotted_aloha", senders, 750.0, load, packets, slots) / expected, 1.0, 0.02)
        << load;
    // That is G exp(-G) of the page but for the number of senders.
    EXPECT_NEAR(expected / (load * std::exp(-load)), 1.0, 0.03);
  }
}

TEST_F(Throughput, ListeningHelpsWhereSoundIsQuickerThanAPacket) {
  const double near_aloha = Of("aloha", 20, 20.0, 1.0, 2e4);
  const double near_csma = Of("csma", 20, 20.0, 1.0, 2e4);
  EXPECT_GT(near_csma, 2.0 * near_aloha);
  const double far_aloha = Of("aloha", 20, 1500.0, 1.0, 2e4);
  const double far_csma = Of("csma", 20, 1500.0, 1.0, 2e4);
  EXPECT_LT(far_csma, 1.1 * far_aloha);
}

class Age : public Simulate {
 protected:
  /// Means over the links to node 0: average and peak.
  static std::pair<double, double> ToNode0(const Result& r) {
    double average = 0.0, peak = 0.0;
    int links = 0;
    for (const auto& link : r.json["links"]) {
      if (link["destination"] != 0) continue;
      average += link["average_age_s"].get<double>();
      peak += link["peak_age_s"].get<double>();
      ++links;
    }
    return {average / links, peak / links};
  }

  /// 8 nodes with slots of 5 s, packets of 3.2 s that travel for 1 s and are made as they leave.
  Result Tdma(double duration_s, double site_db) {
    std::string text = "duration_s: " + std::to_string(duration_s) +
                       "\nseed: 2\nstep_s: 10.0\nchannel:\n  model: physical\n  access: tdma\n"
                       "  modem: {profile: micromodem_fsk_r0}\n"
                       "  slots: {length_s: 5.0, guard_s: 1.0}\n"
                       "  noise: {site_db: " +
                       std::to_string(site_db) + "}\n" + kSteadyWater + Ring(7, 1500.0) +
                       "traffic:\n";
    for (int i = 1; i <= 7; ++i) {
      text +=
          "  - {source: " + std::to_string(i) +
          ", destination: 0, kind: periodic, period_s: 40.0, offset_s: " + std::to_string(5.0 * i) +
          ", bytes: 32}\n";
    }
    return Run(text);
  }
};

TEST_F(Age, OfTdmaWithoutLosses) {
  const Result r = Tdma(40000.0, 0.0);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_EQ(r.json["delivery_ratio"], 1.0);
  EXPECT_EQ(r.json["drops"].size(), 0u);
  const auto [average, peak] = ToNode0(r);
  EXPECT_NEAR(average, 24.2, 0.01 * 24.2);
  EXPECT_NEAR(peak, 44.2, 0.01 * 44.2);
}

TEST_F(Age, OfTdmaWithThreeOfTenPacketsLostInNoise) {
  // The noise that gives this error: bits of non-coherent FSK at 17 dB of processing gain, 3 dB of
  // implementation loss; 22 kHz over 1500 m.
  const double gamma = -2.0 * std::log(2.0 * (1.0 - std::pow(0.7, 1.0 / 256.0)));
  const double f2 = 22.0 * 22.0;
  const double absorbed_db =
      1.5 * (0.11 * f2 / (1 + f2) + 44 * f2 / (4100 + f2) + 2.75e-4 * f2 + 0.003);
  const double level_db = 185.0 - 15.0 * std::log10(1500.0) - absorbed_db;
  const double site_db = level_db - 10.0 * std::log10(gamma) + 10.0 * std::log10(50.0) - 3.0 -
                         10.0 * std::log10(4000.0);
  const Result r = Tdma(400000.0, site_db);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NEAR(r.Number(1, "error_probability"), 0.3, 0.002);
  EXPECT_EQ(r.json["drops"].size(), 1u);
  const auto [average, peak] = ToNode0(r);
  EXPECT_NEAR(average, 41.34, 0.01 * 41.34);
  EXPECT_NEAR(peak, 61.34, 0.01 * 61.34);
}

TEST_F(Age, OfSlottedAloha) {
  // A slot is the airtime and the way of 1500 m: what is sent at its begin is there at its end.
  const double slot_s = kAirtimeS + 1.0;
  const std::string slots = "  slots: {length_s: 1.5035, guard_s: 1.0, send_probability: 0.1}\n";
  const Result r = Run(Head(2e5 * slot_s, "slotted_aloha", slots) + Ring(10, 1500.0) +
                           Sources(10, "kind: periodic, period_s: 1.5035"),
                       "--quiet --summary-only");
  ASSERT_EQ(r.code, 0) << r.err;
  const double P = 0.1 * std::pow(0.9, 9);
  EXPECT_NEAR(0.5 + 1.0 / P, 26.31, 0.005);
  EXPECT_NEAR(ToNode0(r).first / slot_s, 26.31, 0.01 * 26.31);
}

}  // namespace
}  // namespace stg::acoustics
