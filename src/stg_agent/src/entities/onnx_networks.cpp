#include <cmath>

#include "onnx_operators.hpp"
#include "stg_agent/entities/graph_network.hpp"

namespace stg::agent {
namespace {

constexpr const char* kSetNames[] = {"targets", "neighbours", "obstacles"};

/// All numbers are 0 except one, which is 1.
std::vector<float> Selector(int size, int at) {
  std::vector<float> s(static_cast<std::size_t>(size), 0.0F);
  s[static_cast<std::size_t>(at)] = 1.0F;
  return s;
}

/// Mask of each head's own numbers.
std::vector<float> Heads(const GraphSpec& spec, float value) {
  std::vector<float> mask(static_cast<std::size_t>(spec.heads * spec.width), 0.0F);
  const int size = spec.width / spec.heads;
  for (int h = 0; h < spec.heads; ++h) {
    for (int k = h * size; k < (h + 1) * size; ++k) {
      mask[static_cast<std::size_t>(h * spec.width + k)] = value;
    }
  }
  return mask;
}

class GraphWriter {
 public:
  GraphWriter(const GraphSpec& spec, OnnxOperators* to) : spec_(spec), b_(spec), to_(*to) {}

  void Write() {
    Declare();
    const std::string targets = to_.Embed("targets", b_.sets[0]);
    const std::string neighbours = to_.Embed("neighbours", b_.sets[1]);
    const std::string obstacles = to_.Embed("obstacles", b_.sets[2]);
    const float size = static_cast<float>(spec_.width) / static_cast<float>(spec_.heads);
    to_.Fixed("heads_scaled", spec_.heads, spec_.width, Heads(spec_, 1.0F / std::sqrt(size)));
    to_.Fixed("heads", spec_.heads, spec_.width, Heads(spec_, 1.0F));
    to_.Fixed("zero", 1, 1, {0.0F});
    Messages(targets, neighbours);
    WithNobody("targets", "targets_updated", b_.sets[0].nobody);
    WithNobody("neighbours", neighbours, b_.sets[1].nobody);
    WithNobody("obstacles", obstacles, b_.sets[2].nobody);
    Prior();
    const std::string self = to_.Dense("self", "self", b_.self, true);
    std::vector<std::string> joined = {self, "search"};
    for (std::size_t s = 0; s < 3; ++s) {
      joined.push_back(Attend(kSetNames[s], self, b_.attention[s], s == 1));
    }
    for (const char* name : {"targets", "neighbours"}) {
      joined.push_back(to_.Node("ReduceMax", {std::string(name) + "_all"},
                                std::string(name) + "_max", {{"axes", 0}, {"keepdims", 1}}));
    }
    to_.Node("Concat", joined, "joined", {{"axis", 1}});
    const std::string first = to_.Dense("joined", "trunk1", b_.trunk1, true);
    const std::string second = to_.Dense(first, "trunk2", b_.trunk2, true);
    Choose(second);
  }

 private:
  void Declare() {
    to_.Input("self", {1, spec_.self});
    to_.Input("search", {1, spec_.search});
    to_.Input("targets", {0, spec_.targets});
    to_.Input("neighbours", {0, spec_.neighbours});
    to_.Input("obstacles", {0, spec_.obstacles});
    to_.Input("edges", {0, 0, spec_.edges});
    to_.Output("commands", {0, spec_.outputs});
    to_.Output("choices", {1, 0});
  }

  void WithNobody(const std::string& name, const std::string& rows, const PoolBlock& nobody) {
    to_.Node("Concat", {rows, to_.Constant(name + "_nobody", nobody)}, name + "_all",
             {{"axis", 0}});
  }

  void Messages(const std::string& targets, const std::string& neighbours) {
    to_.Node("MatMul", {"edges", to_.Constant("edge_row", b_.edge_row)}, "edges_product");
    to_.Node("MatMul", {neighbours, to_.Constant("edge_neighbour", b_.edge_neighbour)},
             "edges_neighbour");
    to_.Node("Unsqueeze", {"edges_neighbour"}, "edges_neighbours", {{"axes", 0}});
    const std::string base = to_.Dense(targets, "edge_target", b_.edge_target, false);
    to_.Node("Unsqueeze", {base}, "edges_target", {{"axes", 1}});
    to_.Node("Add", {"edges_product", "edges_neighbours"}, "edges_from");
    to_.Node("Add", {"edges_from", "edges_target"}, "edges_sum");
    to_.Node("Add", {base, to_.Constant("edge_nobody", b_.edge_nobody)}, "edges_no");
    to_.Node("Unsqueeze", {"edges_no"}, "edges_nobody", {{"axes", 1}});
    to_.Node("Concat", {"edges_sum", "edges_nobody"}, "edges_all", {{"axis", 1}});
    to_.Node("Relu", {"edges_all"}, "messages");
    to_.Node("ReduceMean", {"messages"}, "messages_mean", {{"axes", 1}, {"keepdims", 0}});
    to_.Node("ReduceMax", {"messages"}, "messages_max", {{"axes", 1}, {"keepdims", 0}});
    to_.Node("Concat", {targets, "messages_mean", "messages_max"}, "target_inputs", {{"axis", 1}});
    to_.Node("Relu", {to_.Dense("target_inputs", "update", b_.update, false)}, "targets_updated");
  }

  /// w ln(quality + 0.01) of every neighbour, and 0 for the row of an empty set.
  void Prior() {
    to_.Node("MatMul",
             {"neighbours",
              to_.Fixed("quality", spec_.neighbours, 1, Selector(spec_.neighbours, spec_.quality))},
             "qualities");
    to_.Node("Relu", {"qualities"}, "qualities_positive");
    to_.Node("Add", {"qualities_positive", to_.Fixed("floor", 1, 1, {kGraphQualityFloor})},
             "qualities_floor");
    to_.Node("Log", {"qualities_floor"}, "qualities_log");
    to_.Node("Concat", {"qualities_log", "zero"}, "qualities_all", {{"axis", 0}});
    to_.Node("MatMul", {"qualities_all", to_.Constant("prior_weight", b_.prior)}, "priors");
    to_.Node("Transpose", {"priors"}, "prior");
  }

  std::string Attend(const std::string& name, const std::string& self,
                     const GraphBlocks::Attention& a, bool prior) {
    const std::string all = name + "_all";
    to_.Node("MatMul", {self, to_.Constant(name + "_query", a.query)}, name + "_q");
    to_.Node("Mul", {name + "_q", "heads_scaled"}, name + "_qs");
    to_.Node("MatMul", {name + "_qs", to_.Upright(name + "_key", a.key)}, name + "_k");
    to_.Node("Transpose", {all}, name + "_t");
    std::string scores = to_.Node("MatMul", {name + "_k", name + "_t"}, name + "_scores");
    if (prior) scores = to_.Node("Add", {scores, "prior"}, name + "_scored");
    to_.Node("Softmax", {scores}, name + "_shares", {{"axis", 1}});
    to_.Node("MatMul", {name + "_shares", all}, name + "_context");
    to_.Node("MatMul", {name + "_context", to_.Constant(name + "_value", a.value)}, name + "_v");
    to_.Node("Mul", {name + "_v", "heads"}, name + "_vs");
    return to_.Node("ReduceSum", {name + "_vs"}, name + "_attended",
                    {{"axes", 0}, {"keepdims", 1}});
  }

  void Choose(const std::string& y) {
    to_.Node("MatMul", {y, to_.Constant("pointer", b_.pointer)}, "pointed");
    to_.Node("MatMul", {"pointed", "targets_t"}, "choices_of_rows");
    to_.Node("MatMul",
             {"targets",
              to_.Fixed("followed", spec_.targets, 1, Selector(spec_.targets, spec_.follows))},
             "follows");
    to_.Node("Concat", {"follows", "zero"}, "follows_all", {{"axis", 0}});
    to_.Node("MatMul", {"follows_all", to_.Constant("follow", b_.follow)}, "follows_worth");
    to_.Node("Transpose", {"follows_worth"}, "follows_row");
    to_.Node("Add", {"choices_of_rows", "follows_row"}, "choices");
    to_.Node("MatMul", {"targets_all", to_.Constant("head_row", b_.head_row)}, "commands_of_rows");
    to_.Node("Add", {"commands_of_rows", to_.Dense(y, "head", b_.head, false)}, "commands_sum");
    to_.Node("Tanh", {"commands_sum"}, "commands");
  }

  const GraphSpec& spec_;
  GraphBlocks b_;
  OnnxOperators& to_;
};

}  // namespace

void WritePool(const PoolSpec& spec, OnnxOperators* to) {
  const PoolBlocks blocks(spec);
  to->Input("self", {1, spec.self});
  to->Input("search", {1, spec.search});
  for (int s = 0; s < spec.sets_count(); ++s) {
    to->Input(kSetNames[s], {0, spec.sets[static_cast<std::size_t>(s)]});
  }
  to->Output("command", {1, spec.outputs});
  std::vector<std::string> joined = {to->Dense("self", "self", blocks.self, true), "search"};
  for (int s = 0; s < spec.sets_count(); ++s) {
    const PoolBlocks::Set& set = blocks.sets[static_cast<std::size_t>(s)];
    const std::string name = kSetNames[s], rows = to->Embed(name, set);
    to->Node("Concat", {rows, to->Constant(name + "_nobody", set.nobody)}, name + "_all",
             {{"axis", 0}});
    joined.push_back(
        to->Node("ReduceMean", {name + "_all"}, name + "_mean", {{"axes", 0}, {"keepdims", 1}}));
    joined.push_back(
        to->Node("ReduceMax", {name + "_all"}, name + "_max", {{"axes", 0}, {"keepdims", 1}}));
  }
  to->Node("Concat", joined, "joined", {{"axis", 1}});
  const std::string first = to->Dense("joined", "trunk1", blocks.trunk1, true);
  const std::string second = to->Dense(first, "trunk2", blocks.trunk2, true);
  to->Node("Tanh", {to->Dense(second, "head", blocks.head, false)}, "command");
}

void WriteGraph(const GraphSpec& spec, OnnxOperators* to) { GraphWriter(spec, to).Write(); }

}  // namespace stg::agent
