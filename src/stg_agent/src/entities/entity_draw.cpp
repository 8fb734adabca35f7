#include "stg_agent/entities/entity_draw.hpp"

#include <algorithm>
#include <cmath>

#include "stg_agent/entities/entity_pilot.hpp"
#include "stg_agent/policy/gaussian.hpp"

namespace stg::agent {

void LogShares(const float* logits, int count, float* log_shares) {
  const float most = *std::max_element(logits, logits + count);
  float sum = 0.0F;
  for (int k = 0; k < count; ++k) sum += std::exp(logits[k] - most);
  for (int k = 0; k < count; ++k) log_shares[k] = logits[k] - (most + std::log(sum));
}

float NoiseKept(const RunConfig& run, EntityAction action, double noise_time_s) {
  if (noise_time_s <= 0.0) return 0.0F;
  return static_cast<float>(std::exp(-CommandPeriod_s(run, action) / noise_time_s));
}

float DrawCommand(const CommandDistribution& of, Random* random, int* choice, float* command) {
  if (of.keep > 0.0F && !of.noise->begun) {
    for (int k = 0; k < of.size; ++k) {
      of.noise->values[static_cast<std::size_t>(k)] = static_cast<float>(random->Normal());
    }
    of.noise->begun = true;
  }
  *choice = 0;
  float log_density = 0.0F;
  if (of.chooses) {
    float log_shares[kMostChoices] = {};
    LogShares(of.logits, of.choices, log_shares);
    double left = random->Uniform();
    while (*choice + 1 < of.choices &&
           (left -= std::exp(static_cast<double>(log_shares[*choice]))) >= 0.0) {
      ++*choice;
    }
    log_density = log_shares[*choice];
  }
  const float* mean = of.means + static_cast<std::ptrdiff_t>(*choice) * of.size;
  std::copy(mean, mean + of.size, command);
  if (of.keep <= 0.0F) return log_density + SampleGaussian(of.log_std, of.size, random, command);
  const float fresh = std::sqrt(1.0F - of.keep * of.keep);
  for (int k = 0; k < of.size; ++k) {
    float& noise = of.noise->values[static_cast<std::size_t>(k)];
    noise = of.keep * noise + fresh * static_cast<float>(random->Normal());
    command[k] += std::exp(of.log_std[k]) * noise;
  }
  return log_density + static_cast<float>(GaussianLogDensity(mean, of.log_std, command, of.size));
}

double LogDensity(const EntityPolicy& policy, const Entities& entities, int choice,
                  const float* command) {
  float logits[kMostChoices], means[kMostChoices * kCommandNumbers];
  const int count = policy.Choices(entities, logits, means);
  const int size = CommandSize(policy.action());
  double log_density = 0.0;
  if (policy.chooses()) {
    float log_shares[kMostChoices] = {};
    LogShares(logits, count, log_shares);
    log_density = static_cast<double>(log_shares[choice]);
  }
  return log_density + GaussianLogDensity(means + choice * size, policy.parameters().log_std.data(),
                                          command, size);
}

bool FlyExploring(const EntityPolicy& policy, const AgentView& agent, Random* random,
                  EntityDecision* decision, float* out) {
  const bool due = CommandDue(agent.memory(), policy.action());
  if (due) {
    BuildEntities(agent, &decision->entities);
    float logits[kMostChoices], means[kMostChoices * kCommandNumbers];
    CommandDistribution of;
    of.chooses = policy.chooses();
    of.choices = policy.Choices(decision->entities, logits, means);
    of.logits = logits;
    of.means = means;
    of.log_std = policy.parameters().log_std.data();
    of.size = CommandSize(policy.action());
    of.keep = NoiseKept(agent.model().run, policy.action(), policy.parameters().noise_time_s);
    of.noise = &agent.memory().noise;
    decision->log_probability = DrawCommand(of, random, &decision->choice, decision->command);
    TakeDecision(agent, decision->entities, policy.action(), of.chooses, decision->choice,
                 decision->command);
  }
  FollowCommand(agent, policy.action(), out);
  return due;
}

}  // namespace stg::agent
