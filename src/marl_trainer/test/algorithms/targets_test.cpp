#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "algorithms/one_step.hpp"

/// The targets of off-policy critics and actors, in closed form.
namespace stg::learn {
namespace {

constexpr double kG = OneStep::kGamma;
constexpr float kGain = 2.0F;
const nlohmann::json kGains = {{"action-gain", 2.0}};

Mlp ActorNetwork(int outputs = OneStep::kAction, float squash = 1.0F) {
  NetworkSpec spec;
  spec.inputs = OneStep::kSeen;
  spec.hidden = {16, 16};
  spec.outputs = outputs;
  spec.squash = squash;
  return Mlp(spec);
}

Mlp CriticNetwork() {
  NetworkSpec spec;
  spec.inputs = OneStep::kState + OneStep::kJoint;
  spec.hidden = {32, 32};
  spec.layer_norm = true;
  return Mlp(spec);
}

/// The actions of all agents, one after the other, of the actor with these parameters.
std::vector<float> JointAction(const std::vector<float>& parameters,
                               const std::vector<float>& seen) {
  std::vector<float> joint;
  for (int i = 0; i < OneStep::kAgents; ++i) {
    for (const float a :
         Outputs(ActorNetwork(), parameters.data(), seen.data() + i * OneStep::kSeen)) {
      joint.push_back(a);
    }
  }
  return joint;
}

/// Value of the critic number k.
double Q(const std::vector<float>& critics, std::size_t k, std::vector<float> state,
         const std::vector<float>& actions) {
  const Mlp network = CriticNetwork();
  for (const float a : actions) state.push_back(kGain * a);
  return static_cast<double>(
      Outputs(network, critics.data() + k * network.parameters(), state.data())[0]);
}

double Square(double x) { return x * x; }

const std::vector<std::string> kDeterministic = {"actor", "target_actor", "critics",
                                                 "target_critics"};
const std::vector<std::string> kSoft = {"actor", "critics", "target_critics"};

/// Makes the deviation of an actor the lower bound for everything that it sees. Its last layer
/// gives means, then deviations.
void SetSmallestDeviation(std::vector<float>* actor) {
  const Mlp network = ActorNetwork(2 * OneStep::kAction, 0.0F);
  const int last = network.layers() - 1, inputs = network.spec().layer_inputs(last);
  const auto weights = actor->begin() + static_cast<std::ptrdiff_t>(network.weight_offset(last));
  std::fill(weights + OneStep::kAction * inputs, weights + 2 * OneStep::kAction * inputs, 0.0F);
  std::fill(actor->end() - OneStep::kAction, actor->end(), -20.0F);
}

TEST(Targets, FollowTheNextStateTheSmallestCriticAndTheTargetNetworks) {
  for (const std::string name : {"maddpg", "matd3", "masac"}) {
    const std::size_t critics = name == "maddpg" ? 1 : 2;
    for (const bool truncated : {false, true}) {
      nlohmann::json options = kGains;
      if (name == "matd3") options["target-noise"] = 0.0;
      // The deviation is so small that the action is the mean, and the entropy has no weight.
      if (name == "masac") options.update({{"min-log-std", -20.0}, {"initial-alpha", 1e-9}});
      OneStep step(name, 64, options);
      step.truncated = truncated;
      step.Shake(name == "masac" ? kSoft : kDeterministic);
      if (critics == 2) step["target_critics"].back() -= 0.5F;
      std::vector<float> after;
      if (name == "masac") {
        SetSmallestDeviation(&step["actor"]);
        for (int i = 0; i < OneStep::kAgents; ++i) {
          const auto means = Outputs(ActorNetwork(2 * OneStep::kAction, 0.0F), step["actor"].data(),
                                     step.after_seen().data() + i * OneStep::kSeen);
          for (std::size_t a = 0; a < OneStep::kAction; ++a) after.push_back(std::tanh(means[a]));
        }
      } else {
        after = JointAction(step["target_actor"], step.after_seen());
      }
      step.Load();
      step.Update();
      const std::vector<float>& targets = step["target_critics"];
      double next = Q(targets, 0, step.after_state(), after);
      if (critics == 2) {
        const double second = Q(targets, 1, step.after_state(), after);
        EXPECT_LT(second, next);
        next = second;
      }
      const double y = static_cast<double>(step.reward) * (1.0 - kG) + kG * next;
      double loss = 0.0;
      for (std::size_t k = 0; k < critics; ++k) {
        loss += Square(Q(step["critics"], k, step.state, step.actions) - y) /
                static_cast<double>(critics);
      }
      EXPECT_NEAR(step.Reported("critic_loss"), loss, 1e-4 * loss) << name << truncated;
    }
  }
}

/// Minus the value of what each AUV would do now. The others' actions are the ones that they took,
/// or the ones that they would take now.
double ActorLoss(OneStep& step, const std::vector<float>& actor, bool others_as_taken) {
  const std::vector<float> now = JointAction(actor, step.seen);
  if (!others_as_taken) return -Q(step["critics"], 0, step.state, now);
  double loss = 0.0;
  for (int i = 0; i < OneStep::kAgents; ++i) {
    std::vector<float> actions = step.actions;
    std::copy_n(now.begin() + i * OneStep::kAction, OneStep::kAction,
                actions.begin() + i * OneStep::kAction);
    loss -= Q(step["critics"], 0, step.state, actions);
  }
  return loss;
}

TEST(Targets, DeterministicActorsClimbTheSumOverAuvsOfTheFirstCritic) {
  for (const char* name : {"maddpg", "matd3"}) {
    for (const std::string others : {"buffer", "policy"}) {
      // Eight samples are fewer than a batch has slices.
      for (const int batch : {64, 8}) {
        nlohmann::json options = kGains;
        options["others"] = others;
        OneStep step(name, batch, options);
        step.Shake(kDeterministic);
        step.Load();
        step.Update();
        const std::vector<float>& actor = step["actor"];
        const bool taken = others == "buffer";
        const double loss = ActorLoss(step, actor, taken);
        const double value = -loss / (taken ? OneStep::kAgents : 1) / (1.0 - kG);
        EXPECT_NEAR(step.Reported("value"), value, 1e-4) << name << others << batch;
        // Adam's first moment is a tenth of the gradient.
        const Archive after = step.Save();
        const std::vector<float>& moment = after.Floats("actor_adam_first");
        for (std::size_t p = actor.size() - OneStep::kAction; p < actor.size(); ++p) {
          constexpr float kStep = 0.02F;
          std::vector<float> more = actor, less = actor;
          more[p] += kStep;
          less[p] -= kStep;
          const double slope = (ActorLoss(step, more, taken) - ActorLoss(step, less, taken)) /
                               static_cast<double>(2.0F * kStep);
          EXPECT_NEAR(10.0F * moment[p], slope, 2e-3) << name << others << batch;
          EXPECT_GT(std::abs(slope), 0.01);
        }
      }
    }
  }
}

TEST(Targets, NoiseOfTheirActionsIsDrawnAndClippedAndTheActionsAre) {
  // The critics return the first action, so (q - y)^2 is its mean square, times gamma^2.
  const auto mean_square = [](float mean, double noise, double clip) {
    OneStep step("matd3", 16000,
                 {{"critic-hidden", {1}},
                  {"activation", "relu"},
                  {"layer-norm", false},
                  {"action-gain", 1.0},
                  {"target-noise", noise},
                  {"target-noise-clip", clip}});
    step.reward = 0.0F;
    for (const std::string& name : kDeterministic) {
      std::fill(step[name].begin(), step[name].end(), 0.0F);
    }
    std::vector<float>& actor = step["target_actor"];
    std::fill(actor.end() - OneStep::kAction, actor.end(), std::atanh(mean));
    std::vector<float>& critics = step["target_critics"];
    constexpr int kInputs = OneStep::kState + OneStep::kJoint;
    for (std::size_t from : {std::size_t{0}, critics.size() / 2}) {
      float* p = critics.data() + from;
      p[OneStep::kState] = 1.0F;
      p[kInputs] = 16.0F;  // here the hinge is straight
      p[kInputs + 1] = 1.0F;
      p[kInputs + 2] = -16.0F;
    }
    step.Load();
    step.Update();
    return step.Reported("critic_loss") / (kG * kG);
  };
  EXPECT_NEAR(mean_square(0.5F, 0.0, 0.5), 0.25, 1e-4);
  EXPECT_NEAR(mean_square(0.0F, 0.1, 0.5), 0.01, 3e-4);
  // The noise almost always reaches its bounds. The actions are 0.6, and 1.2, which is clipped to
  // 1.
  EXPECT_NEAR(mean_square(0.9F, 10.0, 0.3), (0.36 + 1.0) / 2.0, 0.015);
}

TEST(Targets, FollowByTauAtEveryStepOrWithTheDelayedActor) {
  const std::vector<std::tuple<std::string, int, std::vector<std::string>>> cases = {
      {"maddpg", 1, {"critics", "actor"}},
      {"matd3", 3, {"critics", "actor"}},
      {"masac", 1, {"critics"}},
      {"madqn", 1, {"network"}}};
  for (const auto& [name, delay, networks] : cases) {
    nlohmann::json options = {{"lr", 1e-3}, {"tau", 0.25}};
    if (name != "madqn") options["critic-lr"] = 1e-3;
    if (delay > 1) options["policy-delay"] = delay;
    OneStep step(name, 64, options);
    for (const std::string& network : networks) step.Shake({network, "target_" + network});
    step.Load();
    Archive before = step.Save();
    for (int k = 0; k < 7; ++k) {
      step.Update();
      const Archive after = step.Save();
      for (const std::string& network : networks) {
        // The last layer also follows the scale of the rewards. The first number does not.
        const float online = after.Floats(network)[0], was = before.Floats(network)[0];
        const float target = before.Floats("target_" + network)[0];
        const bool moves = k % delay == 0;
        EXPECT_EQ(online != was, moves || network == "critics") << name << network << k;
        EXPECT_NEAR(after.Floats("target_" + network)[0],
                    target + (moves ? 0.25F * (online - target) : 0.0F), 1e-6F)
            << name << network << k;
      }
      before = after;
    }
  }
}

TEST(Targets, OfSoftActorsHaveTheEntropyOfAllAuvs) {
  constexpr double kAlpha = 0.1, kLogStd = -6.0, kRate = 0.01;
  OneStep step("masac", 16000,
               {{"initial-alpha", kAlpha},
                {"alpha-lr", kRate},
                {"target-entropy", -1.5},
                {"min-log-std", kLogStd}});
  for (const std::string& name : kSoft) {
    std::fill(step[name].begin(), step[name].end(), 0.0F);
  }
  // The Gaussians are small and around zero, where the squash is straight.
  SetSmallestDeviation(&step["actor"]);
  const auto value = [&](const char* name, float first, float second) {
    step[name][step[name].size() / 2 - 1] = first;
    step[name].back() = second;
  };
  value("critics", 0.9F, 0.7F);
  value("target_critics", 3.0F, 5.0F);
  step.Load();
  step.Update();
  // log pi of all actions is -n (log sigma + log sqrt(2 pi)) - chi2_n / 2.
  const double log_pi = -OneStep::kJoint * (kLogStd + 0.918938533 + 0.5);
  const double variance = OneStep::kJoint / 2.0;
  double loss = 0.0;
  for (const double q : {0.9, 0.7}) {
    const double y = static_cast<double>(step.reward) * (1.0 - kG) + kG * (3.0 - kAlpha * log_pi);
    loss += (Square(q - y) + Square(kG * kAlpha) * variance) / 2.0;
  }
  EXPECT_NEAR(step.Reported("critic_loss"), loss, 0.01 * loss);
  EXPECT_NEAR(step.Reported("value"), 0.7 / (1.0 - kG), 1e-3);
  // The target is per action. The entropy is below it, so the weight rises.
  const double entropy = step.Reported("entropy");
  EXPECT_NEAR(entropy, -log_pi / OneStep::kAgents, 0.02);
  const Archive after = step.Save();
  EXPECT_NEAR(10.0F * after.Floats("alpha_adam_first")[0], entropy + 1.5 * OneStep::kAction, 1e-3);
  EXPECT_NEAR(after.Floats("log_alpha")[0], std::log(kAlpha) + kRate, 1e-4);
}

TEST(Targets, OfQLearningAreChosenByTheNetworkAndJudgedByItsTarget) {
  constexpr int kBins = 3, kOutputs = 1 + OneStep::kAction * kBins;
  for (const bool truncated : {false, true}) {
    OneStep step("madqn", 64, {{"bins", kBins}});
    step.truncated = truncated;
    step.Shake({"network", "target_network"});
    step.Load();
    step.Update();
    const Mlp network = ActorNetwork(kOutputs, 0.0F);
    const auto advantage = [](const std::vector<float>& out, int head, int bin) {
      const float* a = out.data() + 1 + head * kBins;
      return static_cast<double>(a[bin] - (a[0] + a[1] + a[2]) / 3.0F);
    };
    const auto best = [](const std::vector<float>& out, int head) {
      const auto a = out.begin() + 1 + head * kBins;
      return static_cast<int>(std::max_element(a, a + kBins) - a);
    };
    double loss = 0.0;
    int others = 0;
    for (int i = 0; i < OneStep::kAgents; ++i) {
      const float* after = step.after_seen().data() + i * OneStep::kSeen;
      const auto now = Outputs(network, step["network"].data(), step.seen.data() + i * 3);
      const auto chooses = Outputs(network, step["network"].data(), after);
      const auto judges = Outputs(network, step["target_network"].data(), after);
      double next = static_cast<double>(judges[0]);
      for (int h = 0; h < OneStep::kAction; ++h) {
        next += advantage(judges, h, best(chooses, h)) / OneStep::kAction;
        others += best(chooses, h) != best(judges, h) ? 1 : 0;
      }
      const double y = static_cast<double>(step.reward) * (1.0 - kG) + kG * next;
      for (int h = 0; h < OneStep::kAction; ++h) {
        const float action = step.actions[static_cast<std::size_t>(i * OneStep::kAction + h)];
        const double q =
            static_cast<double>(now[0]) + advantage(now, h, static_cast<int>(action + 1.0F));
        loss += Square(q - y) / OneStep::kJoint;
      }
    }
    EXPECT_GT(others, 0);
    EXPECT_NEAR(step.Reported("critic_loss"), loss, 1e-4 * loss) << truncated;
  }
}

}  // namespace
}  // namespace stg::learn
