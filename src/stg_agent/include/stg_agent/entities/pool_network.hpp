#pragma once

#include <cstddef>
#include <vector>

namespace stg::agent {

/// A network over sets (Deep Sets, Zaheer et al. 2017), described once for the agent, for training
/// and for policy files:
///
///   h_x = relu(V relu(U x + u) + v)            each row x of a set, V and U of that set
///   p   = [mean, max] of the rows h_x and of one learned row that stands for none
///   y   = relu(W2 relu(W1 [relu(W0 self), search, p of every set]))
///   out = W3 y + b3
///
/// So any number of rows from 0 is defined, and their order has no effect but rounding. All numbers
/// stand in one flat array; matrices are [outputs, inputs], row-major.
struct PoolSpec {
  int self = 1;           ///< numbers of the row about oneself
  int search = 0;         ///< further numbers that are always there
  std::vector<int> sets;  ///< numbers of a row of each set
  int outputs = 1;
  int width = 32;   ///< of h_x
  int hidden = 64;  ///< of the other layers

  int sets_count() const { return static_cast<int>(sets.size()); }
  /// Numbers that the trunk takes.
  int joined() const { return hidden + search + 2 * width * sets_count(); }

  bool operator==(const PoolSpec& o) const {
    return self == o.self && search == o.search && sets == o.sets && outputs == o.outputs &&
           width == o.width && hidden == o.hidden;
  }
};

/// A matrix or a vector within the flat array.
struct PoolBlock {
  std::size_t offset = 0;
  int rows = 0, cols = 0;  ///< a vector: one column

  std::size_t size() const {
    return static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  }
};

/// Places of the numbers of a network in the flat array.
struct PoolBlocks {
  explicit PoolBlocks(const PoolSpec& spec);

  struct Layer {
    PoolBlock weight, bias;
  };
  struct Set {
    Layer first, second;
    PoolBlock nobody;  ///< [width]
  };
  std::vector<Set> sets;
  Layer self, trunk1, trunk2, head;
  std::size_t size = 0;
  /// All of them in their order.
  std::vector<PoolBlock> all() const;
};

/// The rows of one set of one AUV.
struct PoolRows {
  const float* rows = nullptr;  ///< [count, stride], of which the set's numbers count
  int count = 0;
  int stride = 0;
};

/// Evaluates one AUV at a time. Immutable; allocates nothing in Forward; sums in an order that
/// depends on the sizes only.
class PoolNetwork {
 public:
  static constexpr int kMaxSets = 4, kMaxWidth = 64, kMaxHidden = 128, kMaxOutputs = 16,
                       kMaxInputs = 256;

  /// Throws UserError for sizes out of bounds, another number of parameters, or numbers that are
  /// not finite.
  PoolNetwork(PoolSpec spec, std::vector<float> parameters);

  /// @param self [spec.self], search [spec.search], sets [spec.sets]
  /// @param out [spec.outputs], the last layer's sums
  void Forward(const float* self, const float* search, const PoolRows* sets, float* out) const;
  /// What the trunk takes of the sets alone, [2 width sets]: mean and max of each; for tests.
  void Pool(const PoolRows* sets, float* pooled) const;

  const PoolSpec& spec() const { return spec_; }
  const PoolBlocks& blocks() const { return blocks_; }
  const std::vector<float>& parameters() const { return parameters_; }

 private:
  PoolSpec spec_;
  PoolBlocks blocks_;
  std::vector<float> parameters_;
};

}  // namespace stg::agent
