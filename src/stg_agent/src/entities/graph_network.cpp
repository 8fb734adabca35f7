#include "stg_agent/entities/graph_network.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "auv_common/error.hpp"
#include "dense.hpp"

namespace stg::agent {
namespace {

constexpr int kWidth = GraphNetwork::kMaxWidth, kRows = GraphNetwork::kMaxRows + 1;

/// Rows of a set after the set's own layers. The row of an empty set comes after them.
struct Hidden {
  alignas(64) float h[kRows][kWidth];
  int count = 0;  // without the row of an empty set
};

void RequireGraph(bool ok, const std::string& what) {
  if (!ok) throw UserError("policy: " + what);
}

void Embed(const float* p, const PoolBlocks::Set& set, const PoolRows& rows, Hidden* out) {
  const int width = set.nobody.rows;
  alignas(64) float first[kWidth];
  out->count = rows.count;
  for (int r = 0; r < rows.count; ++r) {
    Dense(p, set.first, rows.rows + static_cast<std::ptrdiff_t>(r) * rows.stride, true, first);
    Dense(p, set.second, first, true, out->h[r]);
  }
  std::copy(p + set.nobody.offset, p + set.nobody.offset + width, out->h[rows.count]);
}

/// Maximum over the rows, including the row of an empty set.
void Most(const Hidden& x, int width, float* most) {
  std::copy(x.h[0], x.h[0] + width, most);
  for (int r = 1; r <= x.count; ++r) {
    for (int k = 0; k < width; ++k) most[k] = std::max(most[k], x.h[r][k]);
  }
}

/// @param prior [heads][count + 1], or null
void Attend(const float* p, const GraphBlocks::Attention& a, int heads, const float* self,
            const Hidden& x, const float* prior, float* out) {
  const int width = a.key.rows, size = width / heads;
  const auto K = MatrixOf(p, a.key), V = MatrixOf(p, a.value);
  alignas(64) float query[kWidth];
  Product(p, a.query, self, false, query);
  const float scale = 1.0F / std::sqrt(static_cast<float>(size));
  for (int h = 0; h < heads; ++h) {
    // The query is transformed to the rows, so that each row needs one product instead of two.
    alignas(64) float u[kWidth], context[kWidth], weight[kRows];
    Eigen::Map<Eigen::VectorXf> at(u, width);
    at.setZero();
    at.noalias() += K.middleRows(h * size, size).transpose() *
                    Eigen::Map<const Eigen::VectorXf>(query + h * size, size);
    float most = -3e38F;
    for (int r = 0; r <= x.count; ++r) {
      float score = 0.0F;
      for (int k = 0; k < width; ++k) score += u[k] * x.h[r][k];
      weight[r] = score * scale + (prior != nullptr ? prior[h * (x.count + 1) + r] : 0.0F);
      most = std::max(most, weight[r]);
    }
    float sum = 0.0F;
    for (int r = 0; r <= x.count; ++r) sum += weight[r] = std::exp(weight[r] - most);
    std::fill(context, context + width, 0.0F);
    for (int r = 0; r <= x.count; ++r) {
      const float share = weight[r] / sum;
      for (int k = 0; k < width; ++k) context[k] += share * x.h[r][k];
    }
    Eigen::Map<Eigen::VectorXf> y(out + h * size, size);
    y.setZero();
    y.noalias() += V.middleRows(h * size, size) * Eigen::Map<const Eigen::VectorXf>(context, width);
  }
}

/// Messages about which AUV follows which target: h_t' of every target. The row of an empty set
/// stays unchanged.
void PassMessages(const float* p, const GraphBlocks& b, const GraphRows& in,
                  const Hidden& neighbours, Hidden* targets) {
  const int width = b.edge_neighbour.rows, count = neighbours.count;
  alignas(64) float from[kRows][kWidth], base[kWidth], m[kWidth], joined[3 * kWidth];
  for (int j = 0; j < count; ++j) {
    Product(p, b.edge_neighbour, neighbours.h[j], false, from[j]);
  }
  std::copy(p + b.edge_nobody.offset, p + b.edge_nobody.offset + width, from[count]);
  const float share = 1.0F / static_cast<float>(count + 1);
  for (int t = 0; t < targets->count; ++t) {
    float *mean = joined + width, *most = mean + width;
    std::copy(targets->h[t], targets->h[t] + width, joined);
    std::fill(mean, most + width, 0.0F);  // m is never negative, so the maximum may start at 0
    Dense(p, b.edge_target, targets->h[t], false, base);
    for (int j = 0; j <= count; ++j) {
      for (int k = 0; k < width; ++k) m[k] = base[k] + from[j][k];
      if (j < count) {
        Product(p, b.edge_row,
                in.edges + static_cast<std::ptrdiff_t>(t) * in.edge_target_stride +
                    static_cast<std::ptrdiff_t>(j) * in.edge_stride,
                true, m);
      }
      Rectify(m, width);
      for (int k = 0; k < width; ++k) {
        mean[k] += share * m[k];
        most[k] = std::max(most[k], m[k]);
      }
    }
    Dense(p, b.update, joined, true, targets->h[t]);
  }
}

}  // namespace

GraphBlocks::GraphBlocks(const GraphSpec& spec) {
  BlockPlaces places;
  const int width = spec.width;
  const std::array<int, 3> numbers = {spec.targets, spec.neighbours, spec.obstacles};
  for (std::size_t s = 0; s < sets.size(); ++s) {
    sets[s].first = places.Layer(width, numbers[s]);
    sets[s].second = places.Layer(width, width);
    sets[s].nobody = places.Block(width, 1);
  }
  self = places.Layer(spec.hidden, spec.self);
  edge_neighbour = places.Block(width, width);
  edge_row = places.Block(width, spec.edges);
  edge_nobody = places.Block(width, 1);
  edge_target = places.Layer(width, width);
  update = places.Layer(width, 3 * width);
  for (Attention& a : attention) {
    a.query = places.Block(width, spec.hidden);
    a.key = places.Block(width, width);
    a.value = places.Block(width, width);
  }
  prior = places.Block(spec.heads, 1);
  pointer = places.Block(width, spec.hidden);
  follow = places.Block(1, 1);
  trunk1 = places.Layer(spec.hidden, spec.joined());
  trunk2 = places.Layer(spec.hidden, spec.hidden);
  head = places.Layer(spec.outputs, spec.hidden);
  head_row = places.Block(spec.outputs, width);
  size = places.size();
}

std::vector<PoolBlock> GraphBlocks::all() const {
  std::vector<PoolBlock> blocks;
  const auto add = [&blocks](std::initializer_list<PoolBlock> more) {
    blocks.insert(blocks.end(), more);
  };
  for (const PoolBlocks::Set& s : sets) {
    add({s.first.weight, s.first.bias, s.second.weight, s.second.bias, s.nobody});
  }
  add({self.weight, self.bias, edge_neighbour, edge_row, edge_nobody, edge_target.weight,
       edge_target.bias, update.weight, update.bias});
  for (const Attention& a : attention) add({a.query, a.key, a.value});
  add({prior, pointer, follow, trunk1.weight, trunk1.bias, trunk2.weight, trunk2.bias, head.weight,
       head.bias, head_row});
  return blocks;
}

GraphNetwork::GraphNetwork(const GraphSpec& spec, std::vector<float> parameters)
    : spec_(spec), blocks_(spec_), parameters_(std::move(parameters)) {
  const auto within = [](int n, int lo, int hi) { return n >= lo && n <= hi; };
  RequireGraph(within(spec_.width, 1, kMaxWidth) && within(spec_.hidden, 1, kMaxHidden) &&
                   within(spec_.heads, 1, kMaxHeads) && spec_.width % spec_.heads == 0 &&
                   within(spec_.outputs, 1, kMaxOutputs) && within(spec_.self, 1, kMaxInputs) &&
                   within(spec_.search, 0, kMaxInputs) && within(spec_.targets, 1, kMaxInputs) &&
                   within(spec_.neighbours, 1, kMaxInputs) &&
                   within(spec_.obstacles, 1, kMaxInputs) && within(spec_.edges, 1, kMaxInputs) &&
                   within(spec_.quality, 0, spec_.neighbours - 1) &&
                   within(spec_.follows, 0, spec_.targets - 1),
               "a size of the network is out of bounds");
  RequireGraph(parameters_.size() == blocks_.size, "has another number of parameters");
  RequireGraph(std::all_of(parameters_.begin(), parameters_.end(),
                           [](float x) { return std::isfinite(x) && std::abs(x) < 1e6F; }),
               "a number of the network is not finite, or not small");
}

void GraphNetwork::Forward(const GraphRows& in, float* choices, float* out) const {
  const float* p = parameters_.data();
  const int width = spec_.width, heads = spec_.heads;
  alignas(64) float joined[kMaxHidden + kMaxInputs + 5 * kMaxWidth];
  alignas(64) float first[kMaxHidden], second[kMaxHidden], at[kMaxWidth], base[kMaxOutputs];
  Hidden targets, neighbours, obstacles;
  Embed(p, blocks_.sets[0], in.sets[0], &targets);
  Embed(p, blocks_.sets[1], in.sets[1], &neighbours);
  Embed(p, blocks_.sets[2], in.sets[2], &obstacles);
  PassMessages(p, blocks_, in, neighbours, &targets);
  alignas(64) float prior[kMaxHeads * kRows];
  const int rows = neighbours.count + 1;
  for (int r = 0; r < rows; ++r) {
    const PoolRows& n = in.sets[1];
    const float quality =
        r < neighbours.count
            ? GraphPrior(n.rows[static_cast<std::ptrdiff_t>(r) * n.stride + spec_.quality])
            : 0.0F;
    for (int h = 0; h < heads; ++h) {
      prior[h * rows + r] = p[blocks_.prior.offset + static_cast<std::size_t>(h)] * quality;
    }
  }
  Dense(p, blocks_.self, in.self, true, joined);
  float* to = std::copy(in.search, in.search + spec_.search, joined + spec_.hidden);
  Attend(p, blocks_.attention[0], heads, joined, targets, nullptr, to);
  Attend(p, blocks_.attention[1], heads, joined, neighbours, prior, to + width);
  Attend(p, blocks_.attention[2], heads, joined, obstacles, nullptr, to + 2 * width);
  Most(targets, width, to + 3 * width);
  Most(neighbours, width, to + 4 * width);
  Dense(p, blocks_.trunk1, joined, true, first);
  Dense(p, blocks_.trunk2, first, true, second);
  Product(p, blocks_.pointer, second, false, at);
  Dense(p, blocks_.head, second, false, base);
  for (int t = 0; t <= targets.count; ++t) {
    float logit = 0.0F;
    for (int k = 0; k < width; ++k) logit += at[k] * targets.h[t][k];
    if (t < targets.count) {
      logit += p[blocks_.follow.offset] *
               in.sets[0].rows[static_cast<std::ptrdiff_t>(t) * in.sets[0].stride + spec_.follows];
    }
    choices[t] = logit;
    float* command = out + static_cast<std::ptrdiff_t>(t) * spec_.outputs;
    std::copy(base, base + spec_.outputs, command);
    Product(p, blocks_.head_row, targets.h[t], true, command);
  }
}

}  // namespace stg::agent
