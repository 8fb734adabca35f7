#include <random>
#include <tuple>
#include <utility>

#include "acoustic_channel/water/absorption.hpp"
#include "simulate_fixture.hpp"

/// Throughput and age of information of networks against their closed forms.
namespace stg::acoustics {
namespace {

/// Airtime of 32 bytes of evologics_s2c [s].
constexpr double kAirtimeS = 0.1515 + 32 * 0.011;

std::string Sources(int senders, int bytes, const std::string& kind) {
  std::string text = "traffic:\n";
  for (int i = 1; i <= senders; ++i) {
    text += "  - {source: " + std::to_string(i) +
            ", destination: 0, bytes: " + std::to_string(bytes) + ", " + kind + "}\n";
  }
  return text;
}

std::string Head(double duration_s, const std::string& access, const std::string& modem,
                 const std::string& slots = "") {
  return "duration_s: " + std::to_string(duration_s) + "\nseed: 5\nstep_s: 10.0\nchannel:\n" +
         "  model: physical\n  access: " + access + "\n" + slots +
         "  physical:\n    modem: " + modem + "\n" + kSteadyWater;
}

class Throughput : public Simulate {
 protected:
  /// Throughput of node 0 in the middle of a ring, with this load of airtime and about this many
  /// packets.
  double Of(const std::string& access, int senders, double radius_m, double load, double packets,
            const std::string& slots = "") {
    const double duration_s = packets * airtime_s_ / load;
    const double rate_hz = load / (senders * airtime_s_);
    const Result r =
        Run(Head(duration_s, access, modem_, slots) + Ring(senders, radius_m) +
                Sources(senders, bytes_, "kind: poisson, rate_hz: " + std::to_string(rate_hz)),
            "--quiet --summary-only");
    EXPECT_EQ(r.code, 0) << r.err;
    return r.Throughput(0);
  }

  double airtime_s_ = kAirtimeS;
  std::string modem_ = "{profile: evologics_s2c, packet_bytes: 32}";
  int bytes_ = 32;
};

/// Each sender sends one packet and turns around, while it keeps at most one more: M/D/1 with one
/// place to wait. The share of idle time is p0. A packet meets no other one if no other sender is
/// sending at its beginning, and none begins before its end. For N to infinity S = G exp(-2 G).
double FiniteAloha(double load, int senders, double turnaround) {
  const double rate = load / senders;  // per airtime
  const double busy = 1.0 + turnaround, waits = rate * busy;
  const double idle = std::exp(-waits) / (std::exp(-waits) + waits);
  const double sent = (1.0 - idle) / busy;
  const double turning = sent * turnaround * std::exp(-rate * (1.0 + 0.5 * turnaround));
  return senders * sent * std::pow((idle + turning) * std::exp(-rate), senders - 1);
}

/// A sender sends in a slot if any packet came in the slot before: q = 1 - exp(-G / N). For N to
/// infinity S = G exp(-G).
double FiniteSlottedAloha(double load, int senders) {
  const double q = 1.0 - std::exp(-load / senders);
  return senders * q * std::pow(1.0 - q, senders - 1);
}

TEST_F(Throughput, TheFormulasForFewSendersBecomeThoseForMany) {
  for (const auto& [load, pure, slotted] :
       {std::tuple{0.1, .0819, .0905}, {0.5, .1839, .3033}, {1.0, .1353, .3679}}) {
    EXPECT_NEAR(FiniteAloha(load, 1000000, 0.0), pure, 6e-5);
    EXPECT_NEAR(FiniteSlottedAloha(load, 1000000), slotted, 6e-5);
  }
}

TEST_F(Throughput, PureAloha) {
  airtime_s_ = 3.07;
  modem_ = "{profile: micromodem_psk_r3}";
  bytes_ = 512;
  for (const auto& [load, packets] : {std::pair{0.1, 1e4}, {0.5, 5e4}, {1.0, 1e5}, {2.0, 2e5}}) {
    const double expected = FiniteAloha(load, 6, 0.05 / 3.07);
    EXPECT_NEAR(Of("aloha", 6, 750.0, load, packets) / expected, 1.0, 0.02) << load;
  }
}

TEST_F(Throughput, SlottedAloha) {
  // A modem turns around within the guard, so it can also use the next slot.
  const std::string slots = "  slots: {length_s: 0.53, guard_s: 0.025}\n";
  const double used = airtime_s_ / 0.53;
  for (const auto& [load, packets] : {std::pair{0.1, 2e4}, {0.5, 4e4}, {1.0, 6e4}, {2.0, 8e4}}) {
    const double expected = FiniteSlottedAloha(load / used, 10) * used;
    EXPECT_NEAR(Of("slotted_aloha", 10, 750.0, load, packets, slots) / expected, 1.0, 0.02) << load;
  }
}

TEST_F(Throughput, ListeningHelpsWhereSoundIsQuickerThanAPacket) {
  const double near_aloha = Of("aloha", 8, 20.0, 1.0, 2e4);
  const double near_csma = Of("csma", 8, 20.0, 1.0, 2e4);
  EXPECT_GT(near_csma, 2.0 * near_aloha);
  // Neighbours on this ring are 1.3 s apart, which is more than two airtimes. The load is the one
  // that suits ALOHA best. At higher loads, a sender that waits sends less and so loses less.
  const double far_aloha = Of("aloha", 8, 2500.0, 0.4, 2e4);
  const double far_csma = Of("csma", 8, 2500.0, 0.4, 2e4);
  EXPECT_LT(far_csma, 1.03 * far_aloha);
}

/// Non-coherent FSK of 256 bits through noise, slow fading and fading of packets. The test compares
/// what the program delivers over distance with the mean of the same formulas over the draws of
/// another generator.
TEST_F(Throughput, DeliveryOverDistanceIsTheMeanOverTheFading) {
  const double site_db = 99.0;
  const std::vector<double> distances = {500.0, 1000.0, 1500.0, 2000.0};
  std::string text =
      "duration_s: 80000.0\nstep_s: 10.0\nchannel:\n  model: physical\n  access: aloha\n"
      "  physical:\n    modem: {profile: micromodem_fsk_r0}\n    water: {sound_speed: profile}\n"
      "    propagation: {shadowing_time_s: 0.1}\n    noise: {site_db: 99.0}\nnodes:\n" +
      NodeAt(0, 0.0, 0.0);
  for (std::size_t i = 0; i < distances.size(); ++i) {
    text += NodeAt(static_cast<int>(i) + 1, distances[i], 0.0);
  }
  const Result r =
      Run(text + "traffic:\n  - {source: 0, kind: periodic, period_s: 8.0, bytes: 32}\n",
          "--quiet --summary-only");
  ASSERT_EQ(r.code, 0) << r.err;
  std::mt19937_64 generator(1);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    const double d = distances[i];
    const double snr_db = 185.0 - 15.0 * std::log10(d) - ThorpAbsorption(22.0) * d / 1000.0 -
                          site_db - 10.0 * std::log10(4000.0) + 10.0 * std::log10(50.0) - 3.0;
    double sum = 0.0;
    constexpr int kDraws = 100000;
    for (int k = 0; k < kDraws; ++k) {
      const double re = std::sqrt(10.0 / 11.0) + std::sqrt(0.5 / 11.0) * normal(generator);
      const double im = std::sqrt(0.5 / 11.0) * normal(generator);
      const double gamma =
          std::pow(10.0, (snr_db + 3.0 * normal(generator)) / 10.0) * (re * re + im * im);
      sum += std::pow(1.0 - 0.5 * std::exp(-0.5 * gamma), 256.0);
    }
    EXPECT_NEAR(r.json["receivers"][i + 1]["delivered"].get<double>() / 10000.0, sum / kDraws, 0.02)
        << d;
  }
}

class Age : public Simulate {
 protected:
  /// Mean of the average ages and mean of the peak ages over the links to node 0.
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

  /// 8 nodes with slots of 5 s. Packets take 3.2 s, travel for 1 s and are made when they leave.
  Result Tdma(double duration_s, double site_db) {
    std::string text = "duration_s: " + std::to_string(duration_s) +
                       "\nseed: 2\nstep_s: 10.0\nchannel:\n  model: physical\n  access: tdma\n"
                       "  slots: {length_s: 5.0, guard_s: 1.0}\n"
                       "  physical:\n    modem: {profile: micromodem_fsk_r0}\n"
                       "    noise: {site_db: " +
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
  // The noise that causes this loss: bits of non-coherent FSK with 17 dB of processing gain and 3
  // dB of implementation loss, at 22 kHz over 1500 m.
  const double gamma = -2.0 * std::log(2.0 * (1.0 - std::pow(0.7, 1.0 / 256.0)));
  const double f2 = 22.0 * 22.0;
  const double absorbed_db =
      1.5 * (0.11 * f2 / (1 + f2) + 44 * f2 / (4100 + f2) + 2.75e-4 * f2 + 0.003);
  const double level_db = 185.0 - 15.0 * std::log10(1500.0) - absorbed_db;
  const double site_db = level_db - 10.0 * std::log10(gamma) + 10.0 * std::log10(50.0) - 3.0 -
                         10.0 * std::log10(4000.0);
  const Result r = Tdma(300000.0, site_db);
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NEAR(r.Number(1, "error_probability"), 0.3, 0.002);
  EXPECT_EQ(r.json["drops"].size(), 1u);
  const auto [average, peak] = ToNode0(r);
  EXPECT_NEAR(average, 41.34, 0.01 * 41.34);
  EXPECT_NEAR(peak, 61.34, 0.01 * 61.34);
}

TEST_F(Age, OfSlottedAloha) {
  // A slot is the airtime and the travel time over 1500 m. A packet that leaves at its beginning
  // has arrived at its end.
  const double slot_s = kAirtimeS + 1.0;
  const std::string slots = "  slots: {length_s: 1.5035, guard_s: 1.0, send_probability: 0.1}\n";
  const Result r =
      Run(Head(1e5 * slot_s, "slotted_aloha", "{profile: evologics_s2c, packet_bytes: 32}", slots) +
              Ring(10, 1500.0) + Sources(10, 32, "kind: periodic, period_s: 1.5035"),
          "--quiet --summary-only");
  ASSERT_EQ(r.code, 0) << r.err;
  const double P = 0.1 * std::pow(0.9, 9);
  EXPECT_NEAR(0.5 + 1.0 / P, 26.31, 0.005);
  EXPECT_NEAR(ToNode0(r).first / slot_s, 26.31, 0.01 * 26.31);
}

}  // namespace
}  // namespace stg::acoustics
