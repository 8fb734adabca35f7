#include "stg_agent/policy/policy.hpp"

#include <vector>

#include "target.hpp"

/// A policy file. An accepted one can act on observations.
bool stg::fuzz::RunPolicy(const std::string& bytes) {
  return LoadAsFile(bytes, [](const std::string& path) {
    const auto policy = agent::Policy::LoadOnnx(path);
    std::vector<float> observation(static_cast<std::size_t>(policy.observation_size()), 0.5F);
    std::vector<float> action(static_cast<std::size_t>(policy.action_size()));
    policy.Mean(observation.data(), action.data());
  });
}
