#include "stg_agent/policy/policy.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <utility>

#include "auv_common/error.hpp"

namespace stg::agent {
namespace {

constexpr int kPad = 16;

int PadUp(int n) { return (n + kPad - 1) / kPad * kPad; }

void Require(bool ok, const std::string& what) {
  if (!ok) throw UserError("policy: " + what);
}

void RequireWidth(Eigen::Index width, const std::string& what) {
  Require(width >= 1 && width <= Policy::kMaxWidth, what + " has " + std::to_string(width) +
                                                        " numbers, allowed are 1 to " +
                                                        std::to_string(Policy::kMaxWidth));
}

void Validate(const Policy::Parameters& p) {
  RequireWidth(p.input_mean.size(), "the normaliser's mean");
  Require(p.input_std.size() == p.input_mean.size(),
          "the normaliser's mean and standard deviation differ in size");
  Require(p.input_mean.allFinite() && p.input_std.allFinite(), "the normaliser is not finite");
  Require(p.input_std.minCoeff() > 0.0F, "a standard deviation of the normaliser is not positive");
  Require(std::isfinite(p.input_clip) && p.input_clip > 0.0F, "the input clip is not positive");
  Require(!p.layers.empty() && p.layers.size() <= Policy::kMaxLayers,
          std::to_string(p.layers.size()) + " layers, allowed are 1 to " +
              std::to_string(Policy::kMaxLayers));
  Eigen::Index inputs = p.input_mean.size();
  // Largest magnitude that can reach each layer. Beyond float's range, inf - inf would give NaN.
  Eigen::VectorXd bound = Eigen::VectorXd::Constant(inputs, static_cast<double>(p.input_clip));
  for (std::size_t l = 0; l < p.layers.size(); ++l) {
    const std::string name = "layer " + std::to_string(l);
    const Policy::Layer& layer = p.layers[l];
    RequireWidth(layer.weight.rows(), name);
    Require(layer.weight.cols() == inputs, name + " takes " + std::to_string(layer.weight.cols()) +
                                               " numbers but is given " + std::to_string(inputs));
    Require(layer.bias.size() == layer.weight.rows(), name + ": bias and weight differ in size");
    Require(layer.weight.allFinite() && layer.bias.allFinite(), name + " is not finite");
    bound = layer.weight.cwiseAbs().cast<double>() * bound + layer.bias.cwiseAbs().cast<double>();
    Require(bound.maxCoeff() < 1e30, name + " can overflow");
    if (p.activation == Policy::Activation::kTanh) bound = bound.cwiseMin(1.0);
    inputs = layer.weight.rows();
  }
  Eigen::Index actions = inputs;
  if (p.choices.size() > 0) {
    RequireWidth(p.choices.rows(), "the choices");
    Require(inputs % p.choices.rows() == 0,
            "the last layer does not have one output for each choice");
    Require(p.choices.allFinite() && p.choices.cwiseAbs().maxCoeff() <= 1.0F,
            "a choice is not in [-1, 1]");
    actions = inputs / p.choices.rows() * p.choices.cols();
    RequireWidth(actions, "the action");
  }
  Require(p.log_std.size() == actions, "log_std and the actions differ in size");
  Require(p.log_std.allFinite() && p.log_std.cwiseAbs().maxCoeff() <= 20.0F,
          "log_std is not in [-20, 20]");
  const double scale = p.metadata.action_scale;
  Require(std::isfinite(scale) && scale > 0.0 && scale <= 1.0, "action_scale is not in (0, 1]");
}

}  // namespace

std::string ObservationLayout(const ObservationConfig& observation) {
  return ObservationSpec(observation).name();
}

std::string ActionInterfaceName(dynamics::ActionInterface interface) {
  return interface == dynamics::ActionInterface::kVelocity3 ? "velocity3" : "tau6";
}

Policy::Policy(Parameters parameters) : parameters_(std::move(parameters)) {
  Validate(parameters_);
  for (const Layer& layer : parameters_.layers) {
    Packed packed;
    packed.inputs = static_cast<int>(layer.weight.cols());
    packed.outputs = static_cast<int>(layer.weight.rows());
    packed.padded = PadUp(packed.outputs);
    packed.weight.setZero(static_cast<Eigen::Index>(packed.inputs) * packed.padded);
    packed.bias.setZero(packed.padded);
    packed.bias.head(packed.outputs) = layer.bias;
    for (int i = 0; i < packed.inputs; ++i) {
      packed.weight.segment(static_cast<Eigen::Index>(i) * packed.padded, packed.outputs) =
          layer.weight.col(i);
    }
    packed_.push_back(std::move(packed));
  }
}

void Policy::Mean(const float* observation, float* action) const {
  using Aligned = Eigen::Map<Eigen::ArrayXf, Eigen::AlignedMax>;
  using AlignedConst = Eigen::Map<const Eigen::ArrayXf, Eigen::AlignedMax>;
  alignas(64) float buffers[2][kMaxWidth];
  float* in = buffers[0];
  float* out = buffers[1];

  const float clip = parameters_.input_clip;
  const int size = observation_size();
  for (int i = 0; i < size; ++i) {
    assert(std::isfinite(observation[i]));
    const float x = (observation[i] - parameters_.input_mean[i]) / parameters_.input_std[i];
    in[i] = std::min(std::max(x, -clip), clip);
  }
  for (std::size_t l = 0; l < packed_.size(); ++l) {
    const Packed& layer = packed_[l];
    Aligned sum(out, layer.padded);
    const float* so_far = layer.bias.data();
    // Column by column: each output is summed in the order of the inputs, for any SIMD width. Four
    // columns at once need fewer stores.
    const float* column = layer.weight.data();
    int i = 0;
    for (; i + 4 <= layer.inputs; i += 4, column += 4 * layer.padded) {
      const AlignedConst c0(column, layer.padded), c1(column + layer.padded, layer.padded),
          c2(column + 2 * layer.padded, layer.padded), c3(column + 3 * layer.padded, layer.padded);
      sum =
          (((AlignedConst(so_far, layer.padded) + c0 * in[i]) + c1 * in[i + 1]) + c2 * in[i + 2]) +
          c3 * in[i + 3];
      so_far = out;
    }
    for (; i < layer.inputs; ++i, column += layer.padded) {
      sum = AlignedConst(so_far, layer.padded) + AlignedConst(column, layer.padded) * in[i];
      so_far = out;
    }
    const bool last = l + 1 == packed_.size();
    if (last && parameters_.choices.size() > 0) {
      Choose(out, action);
      return;
    }
    if (last || parameters_.activation == Activation::kTanh) {
      sum = sum.tanh();
    } else {
      sum = sum.max(0.0F);
    }
    std::swap(in, out);
  }
  const float scale = static_cast<float>(parameters_.metadata.action_scale);
  for (int a = 0; a < action_size(); ++a) action[a] = scale * in[a];
}

void Policy::Choose(const float* outputs, float* action) const {
  const Eigen::MatrixXf& choices = parameters_.choices;
  const float scale = static_cast<float>(parameters_.metadata.action_scale);
  const auto count = static_cast<int>(choices.rows());
  const int heads = static_cast<int>(parameters_.layers.back().bias.size()) / count;
  for (int h = 0; h < heads; ++h, outputs += count) {
    const auto best = std::max_element(outputs, outputs + count) - outputs;
    for (Eigen::Index d = 0; d < choices.cols(); ++d) *action++ = scale * choices(best, d);
  }
}

void Policy::RequireFits(const AgentModel& model) const {
  const std::string subject = "policy '" + metadata().id + "': ";
  const std::string object = ", the scenario '" + model.run.name + "' has ";
  const ObservationSpec spec(model.observation);
  if (metadata().observation_layout != spec.name()) {
    throw UserError(subject + "observation layout '" + metadata().observation_layout + "'" +
                    object + "'" + spec.name() + "'");
  }
  const std::string interface = ActionInterfaceName(model.control.interface);
  if (metadata().action_interface != interface) {
    throw UserError(subject + "action interface '" + metadata().action_interface + "'" + object +
                    "'" + interface + "'");
  }
  if (observation_size() != spec.size() || action_size() != model.control.action_size()) {
    throw UserError(subject + std::to_string(observation_size()) + " observations and " +
                    std::to_string(action_size()) + " actions" + object +
                    std::to_string(spec.size()) + " and " +
                    std::to_string(model.control.action_size()));
  }
}

std::string PolicyFileOf(const std::string& path, int agent) {
  std::error_code ignored;
  if (std::filesystem::exists(path, ignored)) return path;
  const auto file_of = [&path](int i) {
    std::filesystem::path own = path;
    return own.replace_filename(own.stem().string() + "_" + std::to_string(i) +
                                own.extension().string());
  };
  const std::filesystem::path own = file_of(agent);
  if (std::filesystem::exists(own, ignored)) return own.string();
  if (std::filesystem::exists(file_of(0), ignored)) {
    throw UserError(path + ": AUV " + std::to_string(agent) + " has no policy: there is " +
                    file_of(0).filename().string() + " beside it, for AUV 0, but no " +
                    own.filename().string());
  }
  return path;
}

}  // namespace stg::agent
