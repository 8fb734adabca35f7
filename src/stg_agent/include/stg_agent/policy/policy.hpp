#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "stg_agent/agent_config.hpp"

namespace stg::agent {

/// Origin and interfaces of a policy.
struct PolicyMetadata {
  std::string id;                  ///< name for logs and recorded steps
  std::string observation_layout;  ///< ObservationLayout() of the training scenario
  std::string action_interface;    ///< "velocity3" or "tau6"
  double action_scale = 1.0;       ///< of the policy mean, see Policy
  std::string scenario_hash;       ///< ScenarioHash() of the training scenario
  std::int64_t training_step = 0;  ///< environment steps it was trained for
  std::uint64_t seed = 0;
  std::map<std::string, std::string> metrics;  ///< free text, for people
};

/// Names the observation's layout, e.g. "stg-1:raw+tracking+semantic+graph:nearest".
std::string ObservationLayout(const ObservationConfig& observation);
/// "velocity3" or "tau6".
std::string ActionInterfaceName(dynamics::ActionInterface interface);

/// A deterministic policy: the mean of the actor's Gaussian.
///
///   x = clip((observation - mean) / std, -c, c)
///   x = act(W_l x + b_l)           for every hidden layer l
///   action = action_scale * tanh(W_L x + b_L)
///
/// or, with `choices`, the greedy choice of a Q-network: the last layer's outputs are [heads,
/// choices.rows()], and the action is action_scale times the chosen rows, one of each head.
///
/// Immutable after construction. Evaluation is by Eigen, one row at a time, and
/// sums in an order that depends on the layer sizes only: every program of one
/// build gets the same bits.
class Policy {
 public:
  struct Layer {
    Eigen::MatrixXf weight;  ///< [outputs, inputs]
    Eigen::VectorXf bias;    ///< [outputs]
  };
  enum class Activation { kTanh, kRelu };

  struct Parameters {
    Eigen::VectorXf input_mean, input_std;  ///< [observation_size]
    float input_clip = 10.0F;
    std::vector<Layer> layers;
    Activation activation = Activation::kTanh;  ///< of the hidden layers
    Eigen::VectorXf log_std;  ///< [action_size], for exploration; not used by Mean
    /// What each head chooses from, in [-1, 1]; empty: the actions are squashed outputs.
    Eigen::MatrixXf choices;
    PolicyMetadata metadata;
  };

  static constexpr int kMaxLayers = 8;
  static constexpr int kMaxWidth = 4096;
  static constexpr std::int64_t kMaxFileBytes = 64LL << 20;

  /// Throws UserError when shapes disagree, a size is out of bounds or a number
  /// is not finite.
  explicit Policy(Parameters parameters);

  /// Reads an ONNX file written by SaveOnnx. Accepts the one chain of operators
  /// above (Sub, Div, Clip, Gemm, Tanh or Relu, Mul) and nothing else; throws
  /// UserError that names the file. A file can never run code.
  static Policy LoadOnnx(const std::string& path);

  /// Writes a temporary file beside `path`, then renames it.
  void SaveOnnx(const std::string& path) const;

  /// Mean action of one observation. No allocation, thread-safe.
  /// @param observation [observation_size()], finite.
  /// @param action [action_size()], within +-action_scale.
  void Mean(const float* observation, float* action) const;

  /// Throws UserError unless layout, action interface and sizes are those of the
  /// scenario. (The scenario hash may differ: policies are evaluated elsewhere.)
  void RequireFits(const AgentModel& model) const;

  int observation_size() const { return static_cast<int>(parameters_.input_mean.size()); }
  int action_size() const { return static_cast<int>(parameters_.log_std.size()); }
  const Parameters& parameters() const { return parameters_; }
  const PolicyMetadata& metadata() const { return parameters_.metadata; }

 private:
  void Choose(const float* outputs, float* action) const;

  /// Weights by input column, columns padded to whole SIMD registers.
  struct Packed {
    int inputs, outputs, padded;
    Eigen::VectorXf weight;  ///< [inputs][padded]
    Eigen::VectorXf bias;    ///< [padded]
  };

  Parameters parameters_;
  std::vector<Packed> packed_;
};

/// The policy file of AUV `agent`: `path` if it is a file, otherwise <path without
/// .onnx>_<agent>.onnx if this is a file, otherwise `path`. Throws UserError if the AUV has no file
/// of its own but AUV 0 has one.
std::string PolicyFileOf(const std::string& path, int agent);

}  // namespace stg::agent
