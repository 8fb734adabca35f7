#include "stg_agent/graph/observation_spec.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <set>

#include "stg_agent/graph/observation.hpp"

namespace stg::agent {
namespace {

TEST(ObservationConfig, SaysOfEachKeyWhatReadsIt) {
  ObservationConfig c;
  config::Table table;
  Describe(&c, &table);
  for (const config::Field& field : table.fields()) EXPECT_NO_THROW(ReaderOf(field.path));
  EXPECT_THROW(ReaderOf("observation.grpah"), std::out_of_range);
}

TEST(ObservationSpec, BlocksFollowEachOtherWithoutAGap) {
  for (int options = 0; options < 8; ++options) {
    ObservationConfig c;
    c.tracking = (options & 1) != 0;
    c.semantic = (options & 2) != 0;
    c.graph = (options & 4) != 0;
    const ObservationSpec spec(c);
    int next = 0;
    for (int b = 0; b < kBlockCount; ++b) {
      EXPECT_EQ(spec.offset(static_cast<Block>(b)), next);
      next += spec.size(static_cast<Block>(b));
    }
    EXPECT_EQ(spec.size(), next);
    EXPECT_EQ(spec.size(), 51 + (c.tracking ? 8 : 0) + (c.semantic ? 9 : 0) + (c.graph ? 6 : 0));
    EXPECT_LE(spec.size(), kMaxObservationSize);
  }
}

TEST(ObservationSpec, NameTellsWhatAPolicyFileMustMatch) {
  ObservationConfig c;
  EXPECT_EQ(ObservationSpec(c).name(), "stg-1:raw+tracking+semantic+graph:nearest");
  c.semantic = false;
  c.order = NeighbourOrder::kIndex;
  EXPECT_EQ(ObservationSpec(c).name(), "stg-1:raw+tracking+graph:index");
  EXPECT_NE(ObservationSpec(c), ObservationSpec(ObservationConfig()));
  c.links = c.roles = false;
  EXPECT_EQ(ObservationSpec(c).name(), "stg-1:raw+tracking+graph-links-roles:index");
}

/// The numbers of one block in the observation of this knowledge.
std::vector<double> Shown(const AgentModel& s, const Knowledge<double>& k, Block block) {
  std::vector<double> all;
  BuildObservation(s, k, [&](int index, double value) {
    EXPECT_EQ(index, static_cast<int>(all.size()));
    all.push_back(value);
  });
  EXPECT_EQ(static_cast<int>(all.size()), s.observation_size());
  const ObservationSpec spec(s.observation);
  const auto first = all.begin() + spec.offset(block);
  return {first, first + spec.size(block)};
}

/// Every block must be at the place that the description says.
TEST(ObservationSpec, BuildObservationKeepsToIt) {
  using Numbers = std::vector<double>;
  for (const bool tracking : {true, false}) {
    AgentModel s;
    s.observation.tracking = tracking;
    s.workspace.half_extent_m = 1.0;
    s.vehicle.max_velocity_mps = {1.0, 1.0, 1.0};
    s.vehicle.max_rate_radps = {1.0, 1.0, 1.0};
    Knowledge<double> k{};
    k.R_WB = RotationOf(TrigOf(Vec3<double>{0.0, 0.0, 0.5 * kPi}));  // ahead is world y
    k.trig = {0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
    k.p_WB = {0.1, -0.2, 0.3};
    k.v_WB_B = {0.4, 0.5, 0.6};
    k.w_WB_B = {0.7, 0.8, 0.9};
    k.r_BT_W = {0.0, 0.25, 0.0};
    k.distance = 0.25;
    k.v_WT = {0.0, 0.5, 0.0};
    for (int j = 0; j < kNeighbourSlots; ++j) k.neighbour[j] = {0.1 * j, 0.2, 0.3};
    for (int a = 0; a < dynamics::kWrenchSize; ++a) k.tau[a] = 0.01 * a;
    k.confidence = 0.5;
    k.closest = 1.0;
    k.mean_quality = 0.75;
    EXPECT_EQ(Shown(s, k, Block::kPosition), (Numbers{0.1, -0.2, 0.3}));
    EXPECT_EQ(Shown(s, k, Block::kAttitude), (Numbers{0.1, 0.2, 0.3, 0.4, 0.5, 0.6}));
    EXPECT_EQ(Shown(s, k, Block::kVelocity), (Numbers{0.4, 0.5, 0.6}));
    EXPECT_EQ(Shown(s, k, Block::kRates), (Numbers{0.7, 0.8, 0.9}));
    EXPECT_EQ(Shown(s, k, Block::kTargetOffset), (Numbers{0.0, 0.25, 0.0}));
    EXPECT_EQ(Shown(s, k, Block::kNeighbours)[3], 0.1);
    EXPECT_EQ(Shown(s, k, Block::kWallRoom), (Numbers{0.9, 0.8, 0.7}));
    EXPECT_EQ(Shown(s, k, Block::kTargetVelocity), (Numbers{0.0, 0.5, 0.0}));
    EXPECT_EQ(Shown(s, k, Block::kRelativeVelocity), (Numbers{0.0, 0.5, 0.0}));
    EXPECT_NEAR(Shown(s, k, Block::kTargetOffsetBody)[0], 0.25, 1e-15);
    EXPECT_NEAR(Shown(s, k, Block::kRelativeVelocityBody)[0], 0.5, 1e-15);
    EXPECT_NEAR(Shown(s, k, Block::kLineOfSight)[0], 1.0, 1e-15);
    EXPECT_EQ(Shown(s, k, Block::kForce), (Numbers{0.0, 0.01, 0.02, 0.03, 0.04, 0.05}));
    if (tracking) {
      EXPECT_EQ(Shown(s, k, Block::kTracking)[kZConfidence], 0.5);
    }
    EXPECT_EQ(Shown(s, k, Block::kPhase), (Numbers{1.0, 0.0, 0.0, 0.0}));
    EXPECT_EQ(Shown(s, k, Block::kQuality), (Numbers{0.0, 1.0, 0.0, 0.0}));
    EXPECT_EQ(Shown(s, k, Block::kClosest), (Numbers{1.0}));
    EXPECT_EQ(Shown(s, k, Block::kGraph)[kGraphMeanQuality], 0.75);
  }
}

TEST(ObservationSpec, EveryBlockIsDescribedByANameOfItsOwn) {
  std::set<std::string> names;
  for (const BlockDescription& block : kBlocks) {
    EXPECT_GT(block.size, 0);
    EXPECT_FALSE(std::string(block.content).empty());
    names.insert(block.name);
  }
  EXPECT_EQ(static_cast<int>(names.size()), kBlockCount);
}

TEST(ObservationSpec, TheDocumentationsTableIsThisOne) {
  std::ifstream file(STG_AGENT_PAGE);
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  ASSERT_FALSE(page.empty()) << STG_AGENT_PAGE;
  const ObservationSpec spec{ObservationConfig()};
  std::string table = "| block | numbers | content |\n|---|---|---|\n";
  for (int b = 0; b < kBlockCount; ++b) {
    const int first = spec.offset(static_cast<Block>(b));
    const int last = first + spec.size(static_cast<Block>(b)) - 1;
    table += std::string("| `") + kBlocks[b].name + "` | " + std::to_string(first);
    if (last > first) table += ".." + std::to_string(last);
    table += std::string(" | ") + kBlocks[b].content + " |\n";
  }
  EXPECT_NE(page.find(table + "\n"), std::string::npos) << "it should read\n" << table;
}

/// Eqs. 18-19 by hand, with everything and without what an ablation leaves out.
TEST(ObservationSpec, AnAblatedLinkOrRoleReadsZero) {
  AgentModel model;
  Knowledge<double> k;
  k.effective_fraction = 1.0;
  k.mean_quality = 0.5;
  k.best_quality = 0.75;
  k.confidence = 1.0;
  k.error = 0.0;
  k.mean_neighbour_error = model.observation.error_scale_m / 4.0;
  using Numbers = std::vector<double>;
  EXPECT_EQ(Shown(model, k, Block::kGraph), (Numbers{1.0, 0.5, 0.75, 0.25, 0.25, 1.0}));
  model.observation.links = false;
  EXPECT_EQ(Shown(model, k, Block::kGraph), (Numbers{0.0, 0.0, 0.0, 0.25, 0.25, 1.0}));
  model.observation.roles = false;
  EXPECT_EQ(Shown(model, k, Block::kGraph), (Numbers{0.0, 0.0, 0.0, 0.25, 0.0, 0.0}));
}

}  // namespace
}  // namespace stg::agent
