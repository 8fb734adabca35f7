#include "stg_agent/entities/entity_policy.hpp"

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/testing/temporary_folder.hpp"
#include "entities/entity_examples.hpp"
#include "entities/onnx_interpreter.hpp"

namespace stg::agent {
namespace {

namespace fs = std::filesystem;

EntityPolicy::Parameters DrawnPolicy(EntityNetwork network = EntityNetwork::kPool,
                                     EntityAction action = EntityAction::kGuidance) {
  EntityPolicy::Parameters p;
  p.action = action;
  p.network = network;
  p.numbers.resize(EntityParameters(network, CommandSize(action)));
  Random random(11, Stream::kInit, 0, 0, 0);
  for (float& x : p.numbers) x = static_cast<float>(0.2 * random.Normal());
  p.log_std.assign(static_cast<std::size_t>(CommandSize(action)), -1.25F);
  p.noise_time_s = 60.1;
  p.metadata.id = "drawn";
  p.metadata.scenario_hash = "0123";
  p.metadata.training_step = 42;
  p.metadata.seed = 7;
  p.metadata.metrics["note"] = "text";
  return p;
}

class EntityPolicyFile : public ::testing::TestWithParam<EntityNetwork> {
 protected:
  void SetUp() override {
    file_ = (folder_ / "policy.onnx").string();
    EntityPolicy(DrawnPolicy(GetParam())).SaveOnnx(file_);
  }

  onnx::ModelProto Model() const {
    std::ifstream in(file_, std::ios::binary);
    std::stringstream bytes;
    bytes << in.rdbuf();
    onnx::ModelProto model;
    EXPECT_TRUE(model.ParseFromString(bytes.str()));
    return model;
  }
  /// Changes the model of the file. Returns the message with which the loader refuses it, or
  /// "accepted".
  std::string Refusal(const std::function<void(onnx::ModelProto*)>& change) const {
    onnx::ModelProto model = Model();
    change(&model);
    const std::string changed = (folder_ / "changed.onnx").string();
    std::ofstream(changed, std::ios::binary) << model.SerializeAsString();
    try {
      EntityPolicy::LoadOnnx(changed);
    } catch (const UserError& error) {
      return error.what();
    }
    return "accepted";
  }

  const TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::string file_;
};

OnnxTensor RowsOf(const float* data, int rows, int cols) {
  return {{rows, cols}, std::vector<double>(data, data + rows * cols)};
}

TEST_P(EntityPolicyFile, AnIndependentReaderOfTheFileSeesTheSameCommands) {
  const EntityPolicy policy = EntityPolicy::LoadOnnx(file_);
  for (const int neighbours : {0, 1, 3, 16}) {
    for (const int targets : {0, 1, 5}) {
      Entities e;
      BuildEntities(MakeExample(static_cast<unsigned>(neighbours), neighbours).input(), &e);
      for (int t = 1; t < targets; ++t) {
        std::copy(e.target[0], e.target[0] + kTargetNumbers, e.target[t]);
        e.target[t][2] += 0.1F * static_cast<float>(t);
        std::copy(e.edge[0][0], e.edge[0][0] + kNeighbourRows * kEdgeNumbers, e.edge[t][0]);
        e.edge[t][0][2] += 0.2F * static_cast<float>(t);
      }
      e.targets = targets;
      OnnxTensor edges{{targets, neighbours, kEdgeNumbers}, {}};
      for (int t = 0; t < targets; ++t) {
        edges.x.insert(edges.x.end(), e.edge[t][0], e.edge[t][0] + neighbours * kEdgeNumbers);
      }
      float command[5];
      const int choice = policy.Command(e, command);
      const OnnxInterpreter::Values theirs = OnnxInterpreter::Run(
          Model(), {{"self", RowsOf(e.self, 1, kSelfNumbers)},
                    {"search", RowsOf(e.search, 1, kSearchNumbers)},
                    {"targets", RowsOf(e.target[0], e.targets, kTargetNumbers)},
                    {"neighbours", RowsOf(e.neighbour[0], neighbours, kNeighbourNumbers)},
                    {"obstacles", RowsOf(e.obstacle[0], e.obstacles, kObstacleNumbers)},
                    {"edges", edges}});
      OnnxTensor commands;
      int row = 0;
      if (GetParam() == EntityNetwork::kGraph) {
        const OnnxTensor& choices = theirs.at("choices");
        ASSERT_EQ(choices.shape, (std::vector<int>{1, targets + 1}));
        row = static_cast<int>(std::max_element(choices.x.begin(), choices.x.end()) -
                               choices.x.begin());
        commands = theirs.at("commands");
        ASSERT_EQ(commands.shape, (std::vector<int>{targets + 1, 5}));
      } else {
        commands = theirs.at("command");
        ASSERT_EQ(commands.shape, (std::vector<int>{1, 5}));
      }
      EXPECT_EQ(choice, row);
      for (int k = 0; k < 5; ++k) EXPECT_NEAR(command[k], commands.at(5 * row + k), 1e-5);
    }
  }
}

TEST_P(EntityPolicyFile, ComesBackBitForBit) {
  ASSERT_TRUE(EntityPolicy::IsOne(file_));
  const EntityPolicy::Parameters ours = DrawnPolicy(GetParam());
  const EntityPolicy read = EntityPolicy::LoadOnnx(file_);
  EXPECT_EQ(read.parameters().numbers, ours.numbers);
  EXPECT_EQ(read.parameters().log_std, ours.log_std);
  EXPECT_EQ(read.parameters().noise_time_s, 60.1);
  EXPECT_EQ(read.parameters().network, GetParam());
  EXPECT_EQ(read.metadata().id, "drawn");
  EXPECT_EQ(read.metadata().action_interface, "guidance");
  EXPECT_EQ(read.metadata().observation_layout, kEntityLayout);
  EXPECT_EQ(read.metadata().training_step, 42);
  EXPECT_EQ(read.metadata().metrics.at("note"), "text");
}

TEST_P(EntityPolicyFile, IsRefusedWhenAnythingInItIsNotAsWritten) {
  const auto has = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find("not a policy"), std::string::npos) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  EXPECT_EQ(Refusal([](onnx::ModelProto*) {}), "accepted");
  has(Refusal([](onnx::ModelProto* m) { m->mutable_graph()->mutable_node(0)->set_op_type("If"); }),
      "graph");
  has(Refusal([](onnx::ModelProto* m) { m->mutable_graph()->add_node()->set_op_type("Relu"); }),
      "graph");
  has(Refusal(
          [](onnx::ModelProto* m) { m->mutable_graph()->mutable_initializer(0)->set_dims(0, 27); }),
      "shape");
  has(Refusal([](onnx::ModelProto* m) { m->mutable_graph()->mutable_initializer()->RemoveLast(); }),
      "number of constants");
  has(Refusal([](onnx::ModelProto* m) {
        std::string* raw = m->mutable_graph()->mutable_initializer(0)->mutable_raw_data();
        const float bad = std::nanf("");
        std::memcpy(raw->data(), &bad, sizeof bad);
      }),
      "");
  has(Refusal([](onnx::ModelProto* m) { m->mutable_metadata_props()->RemoveLast(); }), "");
  has(Refusal([](onnx::ModelProto* m) { m->mutable_opset_import(0)->set_version(11); }), "graph");
  for (const char* time : {"0", "-60.0", "10001.0", "nan", "inf", "60.0 s", ""}) {
    has(Refusal([time](onnx::ModelProto* m) {
          for (auto& entry : *m->mutable_metadata_props()) {
            if (entry.key() == "stg.noise_time_s") entry.set_value(time);
          }
        }),
        "'stg.noise_time_s' is not a time");
  }
  EXPECT_FALSE(EntityPolicy::IsOne((folder_ / "missing.onnx").string()));
}

INSTANTIATE_TEST_SUITE_P(Networks, EntityPolicyFile,
                         ::testing::Values(EntityNetwork::kPool, EntityNetwork::kGraph),
                         [](const auto& info) { return EntityNetworkName(info.param); });

TEST(EntityPolicy, RefusesWhatIsNotFinite) {
  EntityPolicy::Parameters p = DrawnPolicy();
  p.numbers[17] = std::nanf("");
  EXPECT_THROW(EntityPolicy{p}, UserError);
  p = DrawnPolicy();
  p.numbers.pop_back();
  EXPECT_THROW(EntityPolicy{p}, UserError);
  p = DrawnPolicy();
  p.log_std.pop_back();
  EXPECT_THROW(EntityPolicy{p}, UserError);
  for (const double time : {-1.0, 10001.0, std::nan("")}) {
    p = DrawnPolicy();
    p.noise_time_s = time;
    EXPECT_THROW(EntityPolicy{p}, UserError) << time;
  }
}

}  // namespace
}  // namespace stg::agent
