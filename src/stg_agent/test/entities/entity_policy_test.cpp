#include "stg_agent/entities/entity_policy.hpp"

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <sstream>

#include "auv_common/error.hpp"
#include "entities/entity_examples.hpp"

namespace stg::agent {
namespace {

namespace fs = std::filesystem;

EntityPolicy::Parameters DrawnPolicy(EntityAction action = EntityAction::kGuidance) {
  EntityPolicy::Parameters p;
  p.action = action;
  p.numbers.resize(PoolBlocks(EntityActorSpec(CommandSize(action))).size);
  Random random(11, Stream::kInit, 0, 0, 0);
  for (float& x : p.numbers) x = static_cast<float>(0.2 * random.Normal());
  p.log_std.assign(static_cast<std::size_t>(CommandSize(action)), -1.25F);
  p.metadata.id = "drawn";
  p.metadata.scenario_hash = "0123";
  p.metadata.training_step = 42;
  p.metadata.seed = 7;
  p.metadata.metrics["note"] = "text";
  return p;
}

class EntityPolicyFile : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "entity_policy_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
    file_ = (folder_ / "policy.onnx").string();
    EntityPolicy(DrawnPolicy()).SaveOnnx(file_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  onnx::ModelProto Model() const {
    std::ifstream in(file_, std::ios::binary);
    std::stringstream bytes;
    bytes << in.rdbuf();
    onnx::ModelProto model;
    EXPECT_TRUE(model.ParseFromString(bytes.str()));
    return model;
  }
  /// What the loader says to the file after a change.
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

  fs::path folder_;
  std::string file_;
};

/// A matrix with a shape of its own, for the reader below.
struct Matrix {
  int rows = 0, cols = 0;
  std::vector<double> x;
  double at(int r, int c) const { return x[static_cast<std::size_t>(r * cols + c)]; }
};

/// Evaluates an ONNX graph by the operators' definitions, in double, whatever graph it is: a
/// reader that shares nothing with the writer's network.
Matrix Interpret(const onnx::ModelProto& model, std::map<std::string, Matrix> values) {
  for (const onnx::TensorProto& t : model.graph().initializer()) {
    Matrix m{static_cast<int>(t.dims(0)), static_cast<int>(t.dims(1)), {}};
    std::vector<float> data(t.raw_data().size() / sizeof(float));
    std::memcpy(data.data(), t.raw_data().data(), t.raw_data().size());
    m.x.assign(data.begin(), data.end());
    values[t.name()] = m;
  }
  for (const onnx::NodeProto& node : model.graph().node()) {
    const std::string& op = node.op_type();
    const Matrix& a = values.at(node.input(0));
    Matrix y;
    if (op == "MatMul") {
      const Matrix& b = values.at(node.input(1));
      EXPECT_EQ(a.cols, b.rows) << node.name();
      y = {a.rows, b.cols, std::vector<double>(static_cast<std::size_t>(a.rows * b.cols))};
      for (int r = 0; r < y.rows; ++r) {
        for (int c = 0; c < y.cols; ++c) {
          for (int k = 0; k < a.cols; ++k) {
            y.x[static_cast<std::size_t>(r * y.cols + c)] += a.at(r, k) * b.at(k, c);
          }
        }
      }
    } else if (op == "Add") {
      const Matrix& b = values.at(node.input(1));
      y = a;
      for (int r = 0; r < y.rows; ++r) {
        for (int c = 0; c < y.cols; ++c) {
          y.x[static_cast<std::size_t>(r * y.cols + c)] += b.at(b.rows == 1 ? 0 : r, c);
        }
      }
    } else if (op == "Relu" || op == "Tanh") {
      y = a;
      for (double& v : y.x) v = op == "Relu" ? std::max(v, 0.0) : std::tanh(v);
    } else if (op == "Concat") {
      const bool down = node.attribute(0).i() == 0;
      for (const std::string& name : node.input()) {
        const Matrix& b = values.at(name);
        if (down) {
          y.rows += b.rows;
          y.cols = b.cols;
          y.x.insert(y.x.end(), b.x.begin(), b.x.end());
        } else {
          EXPECT_EQ(b.rows, 1);
          y.rows = 1;
          y.cols += b.cols;
          y.x.insert(y.x.end(), b.x.begin(), b.x.end());
        }
      }
    } else if (op == "ReduceMean" || op == "ReduceMax") {
      y = {1, a.cols, {}};
      for (int c = 0; c < a.cols; ++c) {
        double sum = 0.0, most = -1e300;
        for (int r = 0; r < a.rows; ++r) {
          sum += a.at(r, c);
          most = std::max(most, a.at(r, c));
        }
        y.x.push_back(op == "ReduceMax" ? most : sum / a.rows);
      }
    } else {
      ADD_FAILURE() << "unknown operator " << op;
    }
    values[node.output(0)] = y;
  }
  return values.at(model.graph().output(0).name());
}

Matrix RowsOf(const float* data, int rows, int cols) {
  return {rows, cols, std::vector<double>(data, data + rows * cols)};
}

TEST_F(EntityPolicyFile, AnIndependentReaderOfTheFileSeesTheSameCommands) {
  const EntityPolicy policy = EntityPolicy::LoadOnnx(file_);
  for (const int neighbours : {0, 1, 3, 16}) {
    for (const int targets : {0, 1, 5}) {
      Entities e;
      BuildEntities(MakeExample(static_cast<unsigned>(neighbours), neighbours).input(), &e);
      for (int t = 1; t < targets; ++t) {
        std::copy(e.target[0], e.target[0] + kTargetNumbers, e.target[t]);
        e.target[t][2] += 0.1F * static_cast<float>(t);
      }
      e.targets = targets;
      float command[5];
      policy.Command(e, command);
      const Matrix theirs =
          Interpret(Model(), {{"self", RowsOf(e.self, 1, kSelfNumbers)},
                              {"search", RowsOf(e.search, 1, kSearchNumbers)},
                              {"targets", RowsOf(e.target[0], e.targets, kTargetNumbers)},
                              {"neighbours", RowsOf(e.neighbour[0], neighbours, kNeighbourNumbers)},
                              {"obstacles", RowsOf(e.obstacle[0], e.obstacles, kObstacleNumbers)}});
      ASSERT_EQ(theirs.cols, 5);
      for (int k = 0; k < 5; ++k) EXPECT_NEAR(command[k], theirs.at(0, k), 1e-5);
    }
  }
}

TEST_F(EntityPolicyFile, ComesBackBitForBit) {
  ASSERT_TRUE(EntityPolicy::IsOne(file_));
  const EntityPolicy::Parameters ours = DrawnPolicy();
  const EntityPolicy read = EntityPolicy::LoadOnnx(file_);
  EXPECT_EQ(read.parameters().numbers, ours.numbers);
  EXPECT_EQ(read.parameters().log_std, ours.log_std);
  EXPECT_EQ(read.metadata().id, "drawn");
  EXPECT_EQ(read.metadata().action_interface, "guidance");
  EXPECT_EQ(read.metadata().observation_layout, kEntityLayout);
  EXPECT_EQ(read.metadata().training_step, 42);
  EXPECT_EQ(read.metadata().metrics.at("note"), "text");
}

TEST_F(EntityPolicyFile, IsRefusedWhenAnythingInItIsNotAsWritten) {
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
  EXPECT_FALSE(EntityPolicy::IsOne((folder_ / "missing.onnx").string()));
}

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
}

}  // namespace
}  // namespace stg::agent
