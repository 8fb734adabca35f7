// What an AUV makes of detections that do not say which target they are of.

#include "stg_agent/inbox/unlabelled_input.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "association/unlabelled.hpp"

namespace stg::agent {
namespace {

using dynamics::Detection;

/// The input and the filters of AUV 0.
struct Listener {
  explicit Listener(const AgentModel& s) : input(s, 0) {
    for (int k = 0; k < s.target.count; ++k) {
      filters.push_back(TargetFilters().Make(s.track.filter, s, 0));
      filters.back()->Clear();
    }
  }
  void Start(int target, const Vec3<double>& p_WT, double std_m) {
    filters[static_cast<std::size_t>(target)]->Start(p_WT, std_m, 0);
  }
  void Step(TimeNs now) {
    input.Give(now, &filters);
    for (auto& filter : filters) filter->Settle(now, {});
  }
  TargetBelief belief(int target) const {
    return filters[static_cast<std::size_t>(target)]->belief();
  }

  UnlabelledInput input;
  UnlabelledInput::Filters filters;
};

Detection PointAt(TimeNs stamp, const Vec3<double>& p_WT) { return PositionAt(stamp, p_WT, 1.0); }

Detection RangeAt(TimeNs stamp, double range_m) {
  Detection d;
  d.stamp = stamp;
  d.kind = dynamics::MeasurementKind::kRange;
  d.range_m = range_m;
  d.range_std_m = 1.0 + 0.01 * range_m;
  return d;
}

NeighbourState PacketOf(int source, const Detection& d) {
  NeighbourState packet;
  packet.source = source;
  packet.generation = d.stamp;
  packet.sightings.push_back(d);
  return packet;
}

double Apart(const TargetBelief& b, const Vec3<double>& p) {
  return std::hypot(b.p_WT.x - p.x, b.p_WT.y - p.y);
}

TEST(UnlabelledInput, KeepsTwoTargetsApartThatPassEachOther) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  const AgentModel s = UnlabelledModel("position");
  for (const double lane_m : {20.0, 40.0}) {
    Listener f(s);
    const auto east = [](int k) { return Vec3<double>{-30.0 + k, 0.0, -40.0}; };
    const auto west = [lane_m](int k) { return Vec3<double>{30.0 - k, lane_m, -40.0}; };
    f.Start(0, east(0), 5.0);
    f.Start(1, west(0), 5.0);
    for (int k = 1; k <= 60; ++k) {
      std::vector<Detection> look;
      for (const Vec3<double>& p : {east(k), west(k)}) {
        look.push_back(
            PointAt(k * kSecond_ns, p + Vec3<double>{noise(random), noise(random), noise(random)}));
      }
      if (k % 2 == 0) std::swap(look[0], look[1]);
      for (const Detection& d : look) f.input.Detect(d);
      f.Step(k * kSecond_ns);
    }
    EXPECT_LT(Apart(f.belief(0), east(60)), 4.0) << lane_m;
    EXPECT_LT(Apart(f.belief(1), west(60)), 4.0) << lane_m;
    EXPECT_EQ(f.input.own_detection(0), 60 * kSecond_ns);
  }
}

TEST(UnlabelledInput, AFalseAlarmOutsideTheGatesChangesNothing) {
  const AgentModel s = UnlabelledModel("position");
  Listener with(s), without(s);
  for (Listener* f : {&with, &without}) {
    f->Start(0, {0.0, 0.0, -40.0}, 10.0);
    f->Start(1, {300.0, 0.0, -40.0}, 10.0);
    for (int k = 1; k <= 20; ++k) {
      f->input.Detect(PointAt(k * kSecond_ns, {0.3 * k, 0.0, -40.0}));
      if (f == &with) f->input.Detect(PointAt(k * kSecond_ns, {150.0, 20.0 * k, -40.0}));
      f->Step(k * kSecond_ns);
    }
  }
  for (int t = 0; t < 2; ++t) {
    EXPECT_EQ(Norm(with.belief(t).p_WT - without.belief(t).p_WT), 0.0);
    EXPECT_EQ(with.belief(t).observed, t == 0);
  }
}

TEST(UnlabelledInput, TakesAMeasurementByItsPlaceAndNotByItsName) {
  // The sender calls target 1 what this AUV calls target 0.
  const AgentModel s = UnlabelledModel("position");
  Listener f(s);
  f.Start(0, {0.0, 0.0, -40.0}, 10.0);
  f.Start(1, {300.0, 0.0, -40.0}, 10.0);
  Detection d = PointAt(kSecond_ns, {5.0, 0.0, -40.0});
  d.target = 1;
  f.input.Hear(PacketOf(2, d));
  f.Step(kSecond_ns);
  EXPECT_TRUE(f.belief(0).observed);
  EXPECT_FALSE(f.belief(1).observed);
  EXPECT_EQ(f.input.own_detection(0), -1) << "it is not an own one";
}

TEST(UnlabelledInput, AnAuvWithoutEstimatesUsesTheNamesOfOthers) {
  const AgentModel s = UnlabelledModel("position");
  Listener f(s);
  f.Start(0, {0.0, 0.0, -40.0}, 10.0);
  Detection d = PointAt(kSecond_ns, {300.0, 0.0, -40.0});
  d.target = 1;
  f.input.Hear(PacketOf(2, d));
  f.Step(kSecond_ns);
  ASSERT_TRUE(f.belief(1).started);
  EXPECT_LT(Apart(f.belief(1), d.p_WT), 1e-6);
  EXPECT_FALSE(f.belief(0).observed);
}

TEST(UnlabelledInput, AMeasurementThatIsRepeatedCountsOnce) {
  const AgentModel s = UnlabelledModel("range");
  Listener once(s), often(s);
  for (Listener* f : {&once, &often}) {
    f->Start(0, {0.0, 100.0, -40.0}, 30.0);
    f->Start(1, {0.0, 150.0, -40.0}, 30.0);
    for (int k = 1; k <= (f == &once ? 1 : 3); ++k) {
      f->input.Hear(PacketOf(1, RangeAt(kSecond_ns, 110.0)));
      f->Step(k * kSecond_ns);
    }
    f->Step(3 * kSecond_ns);
  }
  for (int t = 0; t < 2; ++t) {
    EXPECT_EQ(Norm(once.belief(t).p_WT - often.belief(t).p_WT), 0.0);
    EXPECT_EQ(once.belief(t).observed, often.belief(t).observed);
  }
}

TEST(UnlabelledInput, DoesNotDependOnTheOrderOfInput) {
  const AgentModel s = UnlabelledModel("range");
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> range(40.0, 260.0);
  struct Input {
    int source;
    Detection d;
  };
  std::vector<Input> inputs;
  for (int k = 0; k < 24; ++k)
    inputs.push_back({k % 3, RangeAt((k / 6) * kSecond_ns, range(random))});
  std::vector<Vec3<double>> first;
  for (int trial = 0; trial < 5; ++trial) {
    Listener f(s);
    f.Start(0, {0.0, 100.0, -40.0}, 30.0);
    f.Start(1, {0.0, 200.0, -40.0}, 30.0);
    for (const Input& i : inputs) {
      if (i.source == 0) {
        f.input.Detect(i.d);
      } else {
        f.input.Hear(PacketOf(i.source, i.d));
      }
    }
    f.Step(4 * kSecond_ns);
    for (int t = 0; t < 2; ++t) {
      if (trial == 0) {
        first.push_back(f.belief(t).p_WT);
      } else {
        EXPECT_EQ(Norm(first[static_cast<std::size_t>(t)] - f.belief(t).p_WT), 0.0);
      }
    }
    std::shuffle(inputs.begin(), inputs.end(), random);
  }
}

TEST(UnlabelledInput, FourFittingDetectionsStartAnEstimateThatIsMissing) {
  const AgentModel s = UnlabelledModel("position", 1.0);
  Listener f(s);
  f.Start(0, {0.0, 0.0, -40.0}, 10.0);
  for (int k = 1; k <= Initiation::kNeeded; ++k) {
    EXPECT_FALSE(f.belief(1).started);
    f.input.Detect(PointAt(k * kSecond_ns, {300.0, 0.5 * k, -40.0}));
    f.Step(k * kSecond_ns);
  }
  ASSERT_TRUE(f.belief(1).started);
  EXPECT_LT(Apart(f.belief(1), {300.0, 2.0, -40.0}), 3.0);
}

/// Probability that a chain of false ranges becomes complete. In each look there is one with the
/// probability q, uniform in [0, reach], and it fits with the probability of twice the given
/// distance as a share of the reach. Ends of the interval make it smaller.
double Complete(double q, double reach_m, const double* fits_m, int hits, int looks, int gap) {
  if (hits == Initiation::kNeeded) return 1.0;
  if (looks == 0) return 0.0;
  const double p = q * std::min(1.0, 2.0 * fits_m[gap] / reach_m);
  return p * Complete(q, reach_m, fits_m, hits + 1, looks - 1, 1) +
         (1.0 - p) * Complete(q, reach_m, fits_m, hits, looks - 1, gap + 1);
}

TEST(Initiation, FalseAlarmsStartNoMoreEstimatesThanComputed) {
  const double period_s = 5.0, reach_m = 600.0, q = 0.6;
  const AgentModel s = UnlabelledModel("range", period_s);
  const auto look = [&](int k) { return static_cast<TimeNs>(k * period_s) * kSecond_ns; };
  // Noise of the range that fits worst gives the upper bound.
  Initiation initiation(s);
  double fits_m[Initiation::kLooks + 1] = {};
  for (int gap = 1; gap <= Initiation::kLooks; ++gap) {
    fits_m[gap] = OneTarget(s).Reach(RangeAt(0, reach_m), RangeAt(look(gap), reach_m));
  }
  const double most = Complete(q, reach_m, fits_m, 1, Initiation::kLooks - 1, 1);
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  constexpr int kChains = 200000;
  int complete = 0;
  for (int chain = 0; chain < kChains; ++chain) {
    initiation.Clear();
    for (int k = 0; k < Initiation::kLooks; ++k) {
      if (k > 0 && share(random) >= q) continue;
      const Detection d = RangeAt(look(k), reach_m * share(random));
      if (!initiation.Look(&d, 1)) continue;
      ++complete;
      break;
    }
  }
  const double rate = static_cast<double>(complete) / kChains;
  EXPECT_LT(rate, most + 4.0 * std::sqrt(most / kChains));
  EXPECT_GT(rate, 0.1 * most) << "the bound is not far off";
  EXPECT_LT(most, 0.02);
}

}  // namespace
}  // namespace stg::agent
