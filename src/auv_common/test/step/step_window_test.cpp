#include "auv_common/step/step_window.hpp"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace stg {
namespace {

constexpr TimeNs kTick = 100'000'000;
constexpr double kPatience_s = 1.0;

/// The voices that have spoken of a step. A step is complete when both voices have spoken.
using Voices = std::set<int>;
/// This voice tells where the run is.
constexpr int kTrusted = 0;

class StepWindowTest : public testing::Test {
 protected:
  bool Say(int voice, TimeNs stamp) {
    Voices* voices = window_.At(stamp, now_s_);
    if (voice == kTrusted) window_.Reach(stamp);
    if (voices) voices->insert(voice);
    return voices != nullptr;
  }
  void SayAll(TimeNs stamp) {
    EXPECT_TRUE(Say(0, stamp));
    EXPECT_TRUE(Say(1, stamp));
  }
  bool Take() {
    taken_ = {-1};
    return window_.Take(
        now_s_, kPatience_s, [](const Voices& v) { return v.size() == 2; }, &taken_);
  }
  /// Takes all complete steps. Returns their stamps.
  std::vector<TimeNs> TakeAll() {
    std::vector<TimeNs> stamps;
    while (Take()) stamps.push_back(window_.taken());
    return stamps;
  }

  StepWindow<Voices> window_{8, Voices{}};
  double now_s_ = 100.0;
  Voices taken_;
};

TEST_F(StepWindowTest, AStepIsTakenWhenItIsComplete) {
  EXPECT_FALSE(Take()) << "nothing was said";
  Say(0, 5 * kTick);
  EXPECT_FALSE(Take());
  Say(0, 5 * kTick);
  EXPECT_FALSE(Take()) << "the same voice again";
  Say(1, 5 * kTick);
  EXPECT_FALSE(window_.has_taken());
  ASSERT_TRUE(Take());
  EXPECT_EQ(taken_, (Voices{0, 1}));
  EXPECT_TRUE(window_.has_taken());
  EXPECT_EQ(window_.taken(), 5 * kTick);
  EXPECT_EQ(window_.size(), 0u);
}

TEST_F(StepWindowTest, AnOpenStepCanBeLookedAt) {
  EXPECT_EQ(window_.Open(5 * kTick), nullptr);
  Say(0, 5 * kTick);
  ASSERT_NE(window_.Open(5 * kTick), nullptr);
  EXPECT_EQ(*window_.Open(5 * kTick), (Voices{0}));
  Say(1, 5 * kTick);
  ASSERT_TRUE(Take());
  EXPECT_EQ(window_.Open(5 * kTick), nullptr);
}

TEST_F(StepWindowTest, StepsOutOfOrderAreTakenInOrder) {
  SayAll(3 * kTick);
  Say(0, 1 * kTick);
  SayAll(2 * kTick);
  EXPECT_EQ(TakeAll(), std::vector<TimeNs>{}) << "the oldest is not complete";
  Say(1, 1 * kTick);
  EXPECT_EQ(TakeAll(), (std::vector<TimeNs>{1 * kTick, 2 * kTick, 3 * kTick}));
}

TEST_F(StepWindowTest, TheOldestIsGivenUpAfterItsPatienceOnlyForALaterOne) {
  Say(0, 1 * kTick);
  now_s_ += 100.0;
  EXPECT_FALSE(Take()) << "the run may stand still";
  Say(0, 2 * kTick);
  ASSERT_TRUE(Take());
  EXPECT_EQ(taken_, Voices{0}) << "what there is of it";
  EXPECT_FALSE(Take());
  now_s_ += 0.5 * kPatience_s;
  Say(0, 3 * kTick);
  now_s_ += 0.5 * kPatience_s;
  EXPECT_FALSE(Take()) << "not before its patience is over";
  now_s_ += 1e-3;
  EXPECT_TRUE(Take());
  EXPECT_EQ(window_.taken(), 2 * kTick);
}

TEST_F(StepWindowTest, PatienceWithManyStepsRunsSideBySide) {
  // A voice that is missing for good delays each step by the same time.
  for (int k = 1; k <= 50; ++k) {
    Say(0, k * kTick);
    const std::vector<TimeNs> taken = TakeAll();
    if (k > 6) {
      ASSERT_EQ(taken, std::vector<TimeNs>{(k - 5) * kTick}) << k;
    }
    now_s_ += 0.24;
  }
}

TEST_F(StepWindowTest, WordsAboutStepsThatAreOverAreRefused) {
  SayAll(2 * kTick);
  ASSERT_TRUE(Take());
  EXPECT_FALSE(Say(0, 2 * kTick));
  EXPECT_FALSE(Say(0, 1 * kTick));
  EXPECT_EQ(window_.late(), 2u);
  EXPECT_EQ(window_.size(), 0u);
  // The age does not matter: a party that was asleep does not begin another run.
  EXPECT_FALSE(Say(0, -10000 * kTick));
  SayAll(3 * kTick);
  EXPECT_TRUE(Take());
}

TEST_F(StepWindowTest, ClearBeginsAnotherRunWithTheSameStamps) {
  SayAll(1 * kTick);
  Say(0, 2 * kTick);
  ASSERT_TRUE(Take());
  window_.Clear();
  EXPECT_EQ(window_.size(), 0u);
  EXPECT_FALSE(window_.has_taken());
  SayAll(1 * kTick);
  ASSERT_TRUE(Take());
  EXPECT_EQ(window_.taken(), 1 * kTick);
}

TEST_F(StepWindowTest, StepsFarAheadDoNotSilenceTheOnesBeforeThem) {
  SayAll(1 * kTick);
  ASSERT_TRUE(Take());
  Say(1, 580 * kTick);
  Say(1, 581 * kTick);
  for (int k = 2; k < 100; ++k) {
    now_s_ += 2.0 * kPatience_s;  // a run may stand still for longer than anybody's patience
    EXPECT_EQ(TakeAll(), std::vector<TimeNs>{}) << "between two steps";
    SayAll(k * kTick);
    ASSERT_EQ(TakeAll(), std::vector<TimeNs>{k * kTick});
  }
  EXPECT_EQ(window_.size(), 2u);
  now_s_ += 100.0;
  EXPECT_EQ(TakeAll(), std::vector<TimeNs>{}) << "the run has not come to them";
  Say(kTrusted, 582 * kTick);
  EXPECT_EQ(TakeAll(), (std::vector<TimeNs>{580 * kTick, 581 * kTick}));
}

TEST_F(StepWindowTest, PatienceBeginsWithTheLastWordAboutAnEarlierStep) {
  Say(0, 580 * kTick);
  Say(0, 581 * kTick);
  Say(0, 1 * kTick);
  now_s_ += 0.9;
  Say(1, 1 * kTick);
  ASSERT_TRUE(Take());
  now_s_ += 0.9;
  EXPECT_FALSE(Take()) << "1.8 s after its own first word";
  now_s_ += 0.2;
  EXPECT_TRUE(Take());
}

TEST_F(StepWindowTest, WithoutRoomTheLatestStepGoes) {
  for (int k = 11; k <= 18; ++k) EXPECT_TRUE(Say(0, k * kTick));
  EXPECT_EQ(window_.crowded(), 0u);
  EXPECT_FALSE(Say(0, 19 * kTick)) << "later than all";
  EXPECT_TRUE(Say(1, 18 * kTick)) << "what is open stays open";
  EXPECT_EQ(window_.size(), 8u);
  SayAll(1 * kTick);
  EXPECT_EQ(window_.size(), 8u);
  EXPECT_EQ(window_.crowded(), 2u);
  for (int k = 11; k <= 17; ++k) EXPECT_TRUE(Say(1, k * kTick));
  EXPECT_EQ(TakeAll(), (std::vector<TimeNs>{1 * kTick, 11 * kTick, 12 * kTick, 13 * kTick,
                                            14 * kTick, 15 * kTick, 16 * kTick, 17 * kTick}))
      << "18 was put out";
}

TEST_F(StepWindowTest, FramesBeginBlank) {
  StepWindow<std::vector<int>> window(2, {7, 7});
  *window.At(1, 0.0) = {1};
  EXPECT_EQ(*window.At(2, 0.0), (std::vector<int>{7, 7}));
  EXPECT_EQ(*window.At(1, 0.0), std::vector<int>{1});
}

}  // namespace
}  // namespace stg
