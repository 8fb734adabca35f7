#include "marl_trainer/learn/swarm/network/entity_actor.hpp"

#include <cmath>

#include "stg_agent/entities/entity_draw.hpp"

namespace stg::learn {
namespace {

std::variant<PoolBatch, GraphBatch> NetworkOf(agent::EntityNetwork network, int outputs) {
  if (network == agent::EntityNetwork::kGraph) return GraphBatch(agent::EntityGraphSpec(outputs));
  return PoolBatch(agent::EntityActorSpec(outputs));
}

}  // namespace

EntityActor::EntityActor(agent::EntityNetwork network, int outputs)
    : outputs_(outputs), network_(NetworkOf(network, outputs)) {}

std::size_t EntityActor::parameters() const {
  return std::visit([](const auto& n) { return n.parameters(); }, network_);
}

void EntityActor::Initialise(std::uint64_t seed, std::uint32_t network, float* parameters) const {
  constexpr double kGain = 0.01;
  if (const auto* graph = std::get_if<GraphBatch>(&network_)) {
    InitialiseGraph(graph->blocks(), kGain, seed, network, parameters);
  } else {
    InitialisePool(std::get<PoolBatch>(network_).blocks(), kGain, seed, network, parameters);
  }
}

void EntityActor::Forward(const float* parameters, const PackedRows& x, ActorWorkspace* w) const {
  const auto rows = static_cast<std::size_t>(x.rows());
  w->first.resize(rows + 1);
  const float* sums = nullptr;
  if (const auto* graph = std::get_if<GraphBatch>(&network_)) {
    graph->Forward(parameters, x, &w->graph);
    for (std::size_t r = 0; r <= rows; ++r) {
      w->first[r] = x.offset(0, static_cast<int>(r)) + static_cast<int>(r);
    }
    w->logits.assign(w->graph.choices(), w->graph.choices() + w->first.back());
    sums = w->graph.output();
  } else {
    std::get<PoolBatch>(network_).Forward(parameters, x, &w->pool);
    for (std::size_t r = 0; r <= rows; ++r) w->first[r] = static_cast<int>(r);
    w->logits.assign(rows, 0.0F);
    sums = w->pool.output();
  }
  w->means.resize(w->logits.size() * static_cast<std::size_t>(outputs_));
  for (std::size_t k = 0; k < w->means.size(); ++k) w->means[k] = std::tanh(sums[k]);
  w->d_logits.assign(w->logits.size(), 0.0F);
  w->d_means.assign(w->means.size(), 0.0F);
}

void EntityActor::Backward(const float* parameters, const PackedRows& x, ActorWorkspace* w,
                           float* gradient) const {
  if (const auto* graph = std::get_if<GraphBatch>(&network_)) {
    graph->Backward(parameters, x, w->d_logits.data(), w->d_means.data(), &w->graph, gradient);
  } else {
    std::get<PoolBatch>(network_).Backward(parameters, x, w->d_means.data(), &w->pool, gradient);
  }
}

int LogShares(const ActorWorkspace& w, int row, std::vector<float>* log_shares) {
  const auto begin = static_cast<std::size_t>(w.first[static_cast<std::size_t>(row)]);
  const auto end = static_cast<std::size_t>(w.first[static_cast<std::size_t>(row) + 1]);
  log_shares->resize(end - begin);
  agent::LogShares(w.logits.data() + begin, static_cast<int>(end - begin), log_shares->data());
  return static_cast<int>(end - begin);
}

}  // namespace stg::learn
