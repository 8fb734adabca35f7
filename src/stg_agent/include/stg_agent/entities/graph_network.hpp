#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "stg_agent/entities/pool_network.hpp"

namespace stg::agent {

/// A network over the task graph (targets, neighbours, the edges between them, obstacles) that also
/// chooses a target, described once for the agent, for training and for policy files:
///
///   h_x    = relu(V relu(U x + u) + v)                  each row x of a set, V and U of that set
///   s      = relu(W0 self + b0)
///   m_tj   = relu(Wn h_j + Wt h_t + We e_tj + b)        each edge of target t and neighbour j
///   h_t'   = relu(Wu [h_t, mean_j m_tj, max_j m_tj] + b)
///   a_x    = sum_k softmax_k(q h_k + p_k) h_k           heads, of each set; q from s
///   y      = relu(W2 relu(W1 [s, search, a_t, a_n, a_o, max_t h_t', max_j h_j]))
///   choice = softmax over the rows h_t' and one that stands for "search" of (P y) h + f follows_t
///   out    = W3 y + W4 h_choice + b3
///
/// Mean, max and attention also take one learned row that stands for an empty set, so any number of
/// rows from 0 is defined. The prior p_k of a neighbour is w ln(link quality + 0.01), else 0. All
/// numbers stand in one flat array; matrices are [outputs, inputs], row-major.
struct GraphSpec {
  int self = 1;
  int search = 0;
  int targets = 1, neighbours = 1, obstacles = 1, edges = 1;  ///< numbers of a row
  int quality = 0;                                            ///< link quality within a neighbour
  int follows = 0;                                            ///< 1 within the target it follows
  int outputs = 1;
  int width = 32;   ///< of h_x
  int hidden = 64;  ///< of s and the trunk
  int heads = 4;

  /// Numbers that the trunk takes.
  int joined() const { return hidden + search + 5 * width; }
};

/// Places of the numbers of such a network in the flat array.
struct GraphBlocks {
  explicit GraphBlocks(const GraphSpec& spec);

  using Layer = PoolBlocks::Layer;
  /// The query of the AUV itself to the rows of a set.
  struct Attention {
    PoolBlock query;  ///< [width, hidden]
    PoolBlock key;    ///< [width, width]
    PoolBlock value;  ///< [width, width]
  };
  /// Targets, neighbours, obstacles. The empty row of the targets stands for "search".
  std::array<PoolBlocks::Set, 3> sets;
  Layer self;
  PoolBlock edge_neighbour, edge_row, edge_nobody;
  Layer edge_target, update;
  std::array<Attention, 3> attention;
  PoolBlock prior;    ///< [heads], w
  PoolBlock pointer;  ///< [width, hidden], P
  PoolBlock follow;   ///< [1], f
  Layer trunk1, trunk2, head;
  PoolBlock head_row;  ///< [outputs, width]
  std::size_t size = 0;

  /// All of them in their order.
  std::vector<PoolBlock> all() const;
};

/// The rows of one AUV.
struct GraphRows {
  const float* self = nullptr;
  const float* search = nullptr;
  PoolRows sets[3];              ///< targets, neighbours, obstacles
  const float* edges = nullptr;  ///< of target 0 and neighbour 0
  int edge_target_stride = 0, edge_stride = 0;
};

/// What is added to a link's quality before its logarithm.
inline constexpr float kGraphQualityFloor = 0.01F;
/// ln(quality + 0.01), by which w multiplies. A quality is never negative.
inline float GraphPrior(float quality) {
  return std::log(std::max(quality, 0.0F) + kGraphQualityFloor);
}

/// Evaluates one AUV at a time. Immutable; allocates nothing in Forward; sums in an order that
/// depends on the sizes only.
class GraphNetwork {
 public:
  static constexpr int kMaxWidth = 32, kMaxHidden = 64, kMaxHeads = 8, kMaxOutputs = 16,
                       kMaxInputs = 64, kMaxRows = 32;

  /// Throws UserError for sizes out of bounds, another number of parameters, or numbers that are
  /// not finite.
  GraphNetwork(const GraphSpec& spec, std::vector<float> parameters);

  /// @param choices [targets + 1], the logits: of each target, then of "search"
  /// @param out [targets + 1, outputs], the last layer's sums for each of them
  void Forward(const GraphRows& rows, float* choices, float* out) const;

  const GraphSpec& spec() const { return spec_; }
  const GraphBlocks& blocks() const { return blocks_; }
  const std::vector<float>& parameters() const { return parameters_; }

 private:
  GraphSpec spec_;
  GraphBlocks blocks_;
  std::vector<float> parameters_;
};

}  // namespace stg::agent
