#pragma once

#include <onnx/onnx_pb.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "stg_agent/entities/pool_network.hpp"

namespace stg::agent {

/// Appends operators and constants to a graph of ONNX, one after another.
class OnnxOperators {
 public:
  using Attributes = std::vector<std::pair<std::string, std::int64_t>>;

  /// @param numbers of the network; blocks refer to them
  OnnxOperators(onnx::GraphProto* graph, const std::vector<float>& numbers)
      : graph_(graph), numbers_(numbers) {}

  /// @param dimensions 0: any size, named after the value
  void Input(const std::string& name, const std::vector<int>& dimensions);
  void Output(const std::string& name, const std::vector<int>& dimensions);
  /// Returns the output's name.
  std::string Node(const std::string& op, const std::vector<std::string>& inputs,
                   const std::string& output, const Attributes& attributes = {});

  /// The block as a constant [columns, rows]: the transpose of W, for x W^T.
  std::string Constant(const std::string& name, const PoolBlock& block);
  /// The block without transposition, [rows, columns].
  std::string Upright(const std::string& name, const PoolBlock& block);
  /// A constant that training does not change.
  std::string Fixed(const std::string& name, int rows, int cols, const std::vector<float>& data);
  /// x W^T + b, then the rectifier if `relu`.
  std::string Dense(const std::string& input, const std::string& name,
                    const PoolBlocks::Layer& layer, bool relu);
  /// The two layers of a set.
  std::string Embed(const std::string& name, const PoolBlocks::Set& set);

  /// Block of the n-th constant, and whether it is transposed; size 0: a fixed constant.
  struct Held {
    PoolBlock block;
    bool transposed = false;
  };
  const std::vector<Held>& held() const { return held_; }

 private:
  static void Value(onnx::ValueInfoProto* info, const std::string& name,
                    const std::vector<int>& dimensions);
  void Tensor(const std::string& name, int rows, int cols, const std::vector<float>& data);

  onnx::GraphProto* graph_;
  const std::vector<float>& numbers_;
  std::vector<Held> held_;
};

struct GraphSpec;
/// The operators of PoolNetwork and GraphNetwork, for a policy over entities.
void WritePool(const PoolSpec& spec, OnnxOperators* to);
void WriteGraph(const GraphSpec& spec, OnnxOperators* to);

}  // namespace stg::agent
