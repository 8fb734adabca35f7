#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "marl_trainer/learn/swarm/network/packed_rows.hpp"
#include "marl_trainer/learn/swarm/network/row_attention.hpp"

namespace stg::learn {

/// agent::GraphNetwork for many AUVs at once, with its gradient. It is written by hand, as
/// PoolBatch is. A test compares it with libtorch.
///
/// The choices are packed, too: for AUV r, its targets and then "search", from row offset(0, r) + r
/// on.
class GraphBatch {
 public:
  explicit GraphBatch(const agent::GraphSpec& spec);

  const agent::GraphSpec& spec() const { return spec_; }
  const agent::GraphBlocks& blocks() const { return blocks_; }
  std::size_t parameters() const { return blocks_.size; }

  /// Memory of one thread.
  class Workspace {
   public:
    /// [choices of all AUVs], and the sums of the last layer for each choice, [choices, outputs].
    const float* choices() const { return choices_.data(); }
    const float* output() const { return output_.data(); }

   private:
    friend class GraphBatch;
    struct Set {
      std::vector<float> first, second, d_first, d_second;  // [set rows, width]
    };
    std::array<Set, 3> sets_;
    std::array<RowAttention::Workspace, 3> attention_;
    std::vector<float> from_, base_, edge_, message_, heard_, targets_, prior_;
    std::vector<int> heard_most_, target_most_, neighbour_most_;
    std::vector<float> self_, joined_, hidden1_, hidden2_, pointed_, sums_, choices_, output_;
    std::vector<float> d_from_, d_base_, d_edge_, d_heard_, d_targets_;
    std::vector<float> d_self_, d_joined_, d_hidden1_, d_hidden2_, d_pointed_, d_sums_;
  };

  void Forward(const float* parameters, const PackedRows& x, Workspace* w) const;
  /// Adds d loss / d parameters to `gradient`, from d loss / d choices and d loss / d output. The
  /// rows are the ones of the last Forward.
  void Backward(const float* parameters, const PackedRows& x, const float* d_choices,
                const float* d_output, Workspace* w, float* gradient) const;

 private:
  /// Rows of set s for the attention; the rows of targets are the ones after the messages.
  AttendedRows Attended(int s, const float* p, const PackedRows& x, const Workspace& w) const;
  void PassMessages(const float* p, const PackedRows& x, Workspace* w) const;
  void Join(const float* p, const PackedRows& x, Workspace* w) const;
  void Choose(const float* p, const PackedRows& x, Workspace* w) const;
  void UndoChoose(const float* p, const PackedRows& x, const float* d_choices,
                  const float* d_output, Workspace* w, float* gradient) const;
  void UndoJoin(const float* p, const PackedRows& x, Workspace* w, float* gradient) const;
  void UndoMessages(const float* p, const PackedRows& x, Workspace* w, float* gradient) const;

  agent::GraphSpec spec_;
  agent::GraphBlocks blocks_;
  std::array<RowAttention, 3> attention_;
};

/// The same as InitialisePool, with two exceptions: the weights of the quality are 1, and the
/// present target is preferred to another one by e^4, so that untrained choices rarely change.
void InitialiseGraph(const agent::GraphBlocks& blocks, double output_gain, std::uint64_t seed,
                     std::uint32_t network, float* parameters);

}  // namespace stg::learn
