#pragma once

#include "auv_common/numbers/random.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Exploration with a policy over entities: a choice from its shares, and Gaussian noise (Eq. 37)
/// on the command of this choice. Agents and the collector of a training draw with the same
/// function.
namespace stg::agent {

/// Most choices that a policy has: each row of a target, and to search.
inline constexpr int kMostChoices = kTargetRows + 1;

/// Logarithms of the shares (softmax) of `count` logits.
void LogShares(const float* logits, int count, float* log_shares);

/// The distribution of one command.
struct CommandDistribution {
  bool chooses = false;            ///< false: there is one choice, and no logit is read
  int choices = 1;                 ///< from 1 to kMostChoices
  const float* logits = nullptr;   ///< [choices]
  const float* means = nullptr;    ///< [choices, size]
  const float* log_std = nullptr;  ///< [size]
  int size = kCommandNumbers;
  /// Correlation of the noise with that of the last command (NoiseKept). Above 0 `noise` is read
  /// and written. Each command alone has the density above.
  float keep = 0.0F;
  CommandNoise* noise = nullptr;
};

/// Correlation of the noises of two commands in a row: exp(-CommandPeriod_s(run, action) /
/// noise_time_s).
/// @param noise_time_s correlation time [s]; 0: independent noise, which gives 0
float NoiseKept(const RunConfig& run, EntityAction action, double noise_time_s);

/// Draws a choice and a command. @param command [size], before any clipping
/// Returns the natural log of their density.
float DrawCommand(const CommandDistribution& of, Random* random, int* choice, float* command);

/// A command that was drawn, for training.
struct EntityDecision {
  Entities entities;
  int choice = 0;
  float command[kCommandNumbers] = {};  ///< before any clipping
  float log_probability = 0.0F;
};

/// Natural log of the density that a policy gives a choice and a command. @param command
/// [CommandSize]. The choice must be one of the policy's.
double LogDensity(const EntityPolicy& policy, const Entities& entities, int choice,
                  const float* command);

/// As Fly, but a new command is drawn. Its noise has the policy's correlation time and begins anew
/// in each episode. Returns true if there is a new one. It allocates nothing.
/// @param decision the new command, otherwise unchanged
bool FlyExploring(const EntityPolicy& policy, const AgentView& agent, Random* random,
                  EntityDecision* decision, float* out);

}  // namespace stg::agent
