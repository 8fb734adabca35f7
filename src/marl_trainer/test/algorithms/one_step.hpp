#pragma once

#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "algorithms/game.hpp"
#include "learn/draw.hpp"
#include "marl_trainer/learn/nn/mlp.hpp"

namespace stg::learn {

/// An off-policy algorithm that takes one gradient step per update, on a batch of equal samples of
/// one step. What it reports is therefore about one sample. The test sets its networks. Its
/// normalisers change nothing, except that a reward counts 1 - gamma times.
struct OneStep {
  static constexpr double kGamma = 0.75;
  static constexpr int kEnvs = 64, kAgents = 2, kSeen = 3, kState = 4, kAction = 2;
  static constexpr int kJoint = kAgents * kAction;

  /// @param options replace those of GameSetup and those of a step that moves almost nothing
  OneStep(const std::string& algorithm, int batch, const nlohmann::json& options);

  /// The numbers of the networks that a checkpoint holds by this name. The next Load takes them.
  std::vector<float>& operator[](const std::string& name) {
    return std::get<std::vector<float>>(arrays_.at(name));
  }
  /// Sets other numbers for these networks, all different.
  void Shake(const std::vector<std::string>& names);
  void Load();
  /// Sees the sample in all environments, and learns from it.
  void Update();
  double Reported(const std::string& column) const;
  Archive Save() const;

  // The sample. Actions [kJoint] are within +-1. Half of this is the algorithm's +-kScale.
  static constexpr double kScale = 0.5;
  std::vector<float> seen, state, actions, next_seen, next_state, final_seen, final_state;
  float reward = 0.8F;
  bool truncated = false;
  /// What follows the sample. After the last step this is what was seen before the restart.
  const std::vector<float>& after_seen() const { return truncated ? final_seen : next_seen; }
  const std::vector<float>& after_state() const { return truncated ? final_state : next_state; }

 private:
  const TrainSetup setup_;
  WorkerPool pool_{1};
  std::unique_ptr<Algorithm> algorithm_;
  std::map<std::string, Archive::Array> arrays_;
  UpdateReport report_;
  std::uint32_t updates_ = 0;
};

/// A network's outputs for one row, which begins at `input`.
std::vector<float> Outputs(const Mlp& network, const float* parameters, const float* input);

}  // namespace stg::learn
