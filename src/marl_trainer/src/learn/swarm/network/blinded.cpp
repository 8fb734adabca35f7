#include <algorithm>

#include "auv_common/error.hpp"
#include "marl_trainer/learn/swarm/network/entity_actor.hpp"

/// Weights of a network that stay 0 in an ablation.
namespace stg::learn {
namespace {

/// Marks blocks, or columns of them.
class Marks {
 public:
  explicit Marks(std::size_t count) : marked_(count, false) {}

  void All(const agent::PoolBlock& block) {
    std::fill_n(marked_.begin() + static_cast<std::ptrdiff_t>(block.offset), block.size(), true);
  }
  /// Columns [first, last] of a matrix.
  void Columns(const agent::PoolBlock& block, int first, int last) {
    for (int r = 0; r < block.rows; ++r) {
      for (int c = first; c <= last; ++c) {
        marked_[block.offset + static_cast<std::size_t>(r * block.cols + c)] = true;
      }
    }
  }
  void Set(const agent::PoolBlocks::Set& set) {
    for (const agent::PoolBlock& b :
         {set.first.weight, set.first.bias, set.second.weight, set.second.bias, set.nobody}) {
      All(b);
    }
  }
  std::vector<bool> take() { return std::move(marked_); }

 private:
  std::vector<bool> marked_;
};

/// The blocks that ablations use, for both networks.
struct Seen {
  const agent::PoolBlock *self, *targets, *neighbours;
  const agent::PoolBlocks::Set* neighbour_set;
  const agent::PoolBlock *trunk, *edge_row = nullptr, *edge_neighbour = nullptr,
                                 *edge_nobody = nullptr, *prior = nullptr;
  int search = 0;  // first column of the search row in the trunk
};

void NoEdges(const Seen& s, Marks* marks) {
  for (const agent::PoolBlock* b : {s.edge_row, s.edge_neighbour, s.edge_nobody}) {
    if (b != nullptr) marks->All(*b);
  }
}

void NoNeighbours(const Seen& s, Marks* marks) {
  marks->Set(*s.neighbour_set);
  marks->Columns(*s.self, agent::kSelfNeighbours, agent::kSelfNeighbours);
  NoEdges(s, marks);
}

void NoGraph(const Seen& s, Marks* marks) {
  NoNeighbours(s, marks);
  marks->Columns(*s.self, agent::kSelfGraph, agent::kSelfGraph + 5);
  marks->Columns(*s.targets, agent::kTargetPhase, agent::kTargetPhase + 7);
}

void NoAge(const Seen& s, Marks* marks) {
  marks->Columns(*s.neighbours, agent::kNeighbourAge, agent::kNeighbourAge);
  marks->Columns(*s.neighbours, agent::kNeighbourAge + 2, agent::kNeighbourAge + 2);
  marks->Columns(*s.targets, agent::kTargetAge, agent::kTargetAge + 1);
  if (s.edge_row != nullptr) marks->Columns(*s.edge_row, agent::kEdgeAge, agent::kEdgeAge);
}

void NoCovariance(const Seen& s, Marks* marks) {
  marks->Columns(*s.targets, agent::kTargetDeviation, agent::kTargetDeviation + 5);
  marks->Columns(*s.neighbours, agent::kNeighbourAge + 1, agent::kNeighbourAge + 1);
  marks->Columns(*s.self, agent::kSelfDeviation, agent::kSelfDeviation);
}

void NoLinks(const Seen& s, Marks* marks) {
  marks->Columns(*s.neighbours, agent::kNeighbourQuality, agent::kNeighbourQuality);
  marks->Columns(*s.self, agent::kSelfGraph, agent::kSelfGraph + 2);
  if (s.prior != nullptr) marks->All(*s.prior);
}

void NoSearch(const Seen& s, Marks* marks) {
  marks->Columns(*s.trunk, s.search, s.search + agent::kSearchNumbers - 1);
}

void NoCommand(const Seen& s, Marks* marks) {
  marks->Columns(*s.self, agent::kSelfCommand, agent::kSelfCommand + agent::kCommandNumbers - 1);
}

void Nothing(const Seen&, Marks*) {}

constexpr struct {
  const char* name;
  void (*blind)(const Seen&, Marks*);
} kBlind[] = {
    {"nothing", Nothing}, {"neighbours", NoNeighbours}, {"graph", NoGraph}, {"edges", NoEdges},
    {"age", NoAge},       {"covariance", NoCovariance}, {"links", NoLinks}, {"search", NoSearch}};

}  // namespace

std::vector<std::string> BlindNames() {
  std::vector<std::string> names;
  for (const auto& b : kBlind) names.emplace_back(b.name);
  return names;
}

std::vector<bool> Blinded(agent::EntityNetwork network, int outputs, const std::string& without,
                          bool last_command) {
  const auto* found = std::find_if(std::begin(kBlind), std::end(kBlind),
                                   [&without](const auto& b) { return without == b.name; });
  if (found == std::end(kBlind)) {
    throw UserError("without '" + without + "': none of " + JoinNames(BlindNames()));
  }
  Marks marks(agent::EntityParameters(network, outputs));
  if (network == agent::EntityNetwork::kGraph) {
    const agent::GraphSpec spec = agent::EntityGraphSpec(outputs);
    const agent::GraphBlocks b(spec);
    const Seen seen{&b.self.weight,    &b.sets[0].first.weight, &b.sets[1].first.weight,
                    &b.sets[1],        &b.trunk1.weight,        &b.edge_row,
                    &b.edge_neighbour, &b.edge_nobody,          &b.prior,
                    spec.hidden};
    found->blind(seen, &marks);
    if (!last_command) NoCommand(seen, &marks);
  } else {
    const agent::PoolSpec spec = agent::EntityActorSpec(outputs);
    const agent::PoolBlocks b(spec);
    Seen seen{&b.self.weight, &b.sets[0].first.weight, &b.sets[1].first.weight, &b.sets[1],
              &b.trunk1.weight};
    seen.search = spec.hidden;
    found->blind(seen, &marks);
    if (!last_command) NoCommand(seen, &marks);
  }
  return marks.take();
}

}  // namespace stg::learn
