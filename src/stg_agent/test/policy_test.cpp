#include "stg_agent/policy.hpp"

#include <gtest/gtest.h>
#include <onnx/checker.h>
#include <onnx/onnx_pb.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <random>
#include <sstream>
#include <thread>

#include "auv_dynamics/error.hpp"

namespace {
std::atomic<long> allocations{0};
}
// Eigen allocates by malloc, so counting operator new would miss it.
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}

namespace stg {
namespace {

namespace fs = std::filesystem;

Policy::Parameters RandomParameters(const std::vector<int>& sizes, Policy::Activation activation,
                                    unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal;
  const auto draw = [&](float scale) { return [&, scale] { return scale * normal(rng); }; };
  Policy::Parameters p;
  p.input_mean = Eigen::VectorXf::NullaryExpr(sizes.front(), draw(1.0F));
  p.input_std = Eigen::VectorXf::NullaryExpr(sizes.front(), draw(1.0F)).array().abs() + 0.01F;
  p.activation = activation;
  for (std::size_t l = 1; l < sizes.size(); ++l) {
    const float gain = 1.0F / std::sqrt(static_cast<float>(sizes[l - 1]));
    Policy::Layer layer;
    layer.weight = Eigen::MatrixXf::NullaryExpr(sizes[l], sizes[l - 1], draw(gain));
    layer.bias = Eigen::VectorXf::NullaryExpr(sizes[l], draw(0.1F));
    p.layers.push_back(layer);
  }
  p.log_std = Eigen::VectorXf::Constant(sizes.back(), -1.2345678F);
  p.metadata.id = "test";
  p.metadata.observation_layout = ObservationLayout(Scenario());
  p.metadata.action_interface = "velocity3";
  p.metadata.action_scale = 0.75;
  p.metadata.scenario_hash = "0123456789abcdef";
  p.metadata.training_step = 123456789;
  p.metadata.seed = 18446744073709551615ULL;
  p.metadata.metrics = {{"return", "1040.5"}};
  return p;
}

/// The definition in double precision, written without the class under test.
std::vector<double> Reference(const Policy::Parameters& p, const std::vector<float>& observation) {
  Eigen::VectorXd x(p.input_mean.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double z = (double(observation[std::size_t(i)]) - p.input_mean[i]) / p.input_std[i];
    x[i] = std::fmin(std::fmax(z, -p.input_clip), p.input_clip);
  }
  for (std::size_t l = 0; l < p.layers.size(); ++l) {
    x = (p.layers[l].weight.cast<double>() * x + p.layers[l].bias.cast<double>()).eval();
    const bool tanh = l + 1 == p.layers.size() || p.activation == Policy::Activation::kTanh;
    for (double& v : x) v = tanh ? std::tanh(v) : std::fmax(v, 0.0);
  }
  std::vector<double> action;
  for (const double v : x) action.push_back(p.metadata.action_scale * v);
  return action;
}

std::vector<float> RandomObservation(int size, unsigned seed) {
  std::mt19937 rng(seed);
  std::normal_distribution<float> normal(0.0F, 2.0F);
  std::vector<float> o(static_cast<std::size_t>(size));
  for (float& v : o) v = normal(rng);
  return o;
}

class PolicyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string name = (fs::temp_directory_path() / "policy_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string Path(const std::string& name) const { return (folder_ / name).string(); }

  std::string Bytes(const std::string& path) const {
    std::ifstream in(path, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  void Write(const std::string& path, const std::string& bytes) const {
    std::ofstream(path, std::ios::binary) << bytes;
  }
  /// Saves a good policy, lets `change` spoil the model, and expects a refusal
  /// that names the file and contains `reason`.
  void ExpectRefused(const std::function<void(onnx::ModelProto*)>& change,
                     const std::string& reason) {
    Policy(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1)).SaveOnnx(Path("good.onnx"));
    onnx::ModelProto model;
    ASSERT_TRUE(model.ParseFromString(Bytes(Path("good.onnx"))));
    change(&model);
    Write(Path("bad.onnx"), model.SerializeAsString());
    ExpectFileRefused(Path("bad.onnx"), reason);
  }
  void ExpectFileRefused(const std::string& path, const std::string& reason) {
    try {
      Policy::LoadOnnx(path);
      FAIL() << "accepted; expected: " << reason;
    } catch (const UserError& error) {
      EXPECT_NE(std::string(error.what()).find(path), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }

  fs::path folder_;
};

TEST_F(PolicyTest, MeanIsTheDefinition) {
  for (const auto activation : {Policy::Activation::kTanh, Policy::Activation::kRelu}) {
    for (const std::vector<int>& sizes :
         {std::vector<int>{74, 64, 64, 3}, {74, 256, 256, 256, 6}, {5, 7, 3}, {51, 1}}) {
      const Policy::Parameters p = RandomParameters(sizes, activation, 3);
      const Policy policy(p);
      for (unsigned k = 0; k < 20; ++k) {
        const std::vector<float> o = RandomObservation(sizes.front(), k);
        std::vector<float> action(static_cast<std::size_t>(sizes.back()));
        policy.Mean(o.data(), action.data());
        const std::vector<double> expected = Reference(p, o);
        for (std::size_t a = 0; a < action.size(); ++a) EXPECT_NEAR(action[a], expected[a], 2e-6);
      }
    }
  }
}

TEST_F(PolicyTest, ObservationsAreClippedAfterNormalisation) {
  Policy::Parameters p = RandomParameters({1, 1}, Policy::Activation::kTanh, 1);
  p.input_mean[0] = 1.0F;
  p.input_std[0] = 2.0F;
  p.layers[0].weight(0, 0) = 0.01F;
  p.layers[0].bias[0] = 0.0F;
  const float far = 1e6F;
  float action;
  Policy(p).Mean(&far, &action);
  EXPECT_NEAR(action, 0.75 * std::tanh(0.1), 1e-6);
}

TEST_F(PolicyTest, OnnxRoundTripIsExact) {
  const Policy::Parameters p = RandomParameters({74, 64, 32, 3}, Policy::Activation::kRelu, 5);
  Policy(p).SaveOnnx(Path("p.onnx"));
  const Policy loaded = Policy::LoadOnnx(Path("p.onnx"));
  const Policy::Parameters& q = loaded.parameters();
  EXPECT_EQ(q.input_mean, p.input_mean);
  EXPECT_EQ(q.input_std, p.input_std);
  EXPECT_EQ(q.input_clip, p.input_clip);
  EXPECT_EQ(q.log_std, p.log_std);
  EXPECT_EQ(q.activation, p.activation);
  ASSERT_EQ(q.layers.size(), p.layers.size());
  for (std::size_t l = 0; l < p.layers.size(); ++l) {
    EXPECT_EQ(q.layers[l].weight, p.layers[l].weight);
    EXPECT_EQ(q.layers[l].bias, p.layers[l].bias);
  }
  EXPECT_EQ(q.metadata.id, p.metadata.id);
  EXPECT_EQ(q.metadata.observation_layout, p.metadata.observation_layout);
  EXPECT_EQ(q.metadata.action_interface, p.metadata.action_interface);
  EXPECT_EQ(q.metadata.action_scale, p.metadata.action_scale);
  EXPECT_EQ(q.metadata.scenario_hash, p.metadata.scenario_hash);
  EXPECT_EQ(q.metadata.training_step, p.metadata.training_step);
  EXPECT_EQ(q.metadata.seed, p.metadata.seed);
  EXPECT_EQ(q.metadata.metrics, p.metadata.metrics);
}

TEST_F(PolicyTest, FileIsValidOnnx) {
  Policy(RandomParameters({74, 64, 64, 3}, Policy::Activation::kTanh, 5)).SaveOnnx(Path("p.onnx"));
  onnx::ModelProto model;
  ASSERT_TRUE(model.ParseFromString(Bytes(Path("p.onnx"))));
  EXPECT_NO_THROW(onnx::checker::check_model(model));
}

TEST_F(PolicyTest, OpenCvReadsTheFileAndAgrees) {
  for (const auto activation : {Policy::Activation::kTanh, Policy::Activation::kRelu}) {
    const int rows = 32;
    const Policy policy(RandomParameters({74, 64, 64, 3}, activation, 11));
    policy.SaveOnnx(Path("p.onnx"));
    std::string inputs;
    std::vector<float> expected;
    for (unsigned k = 0; k < rows; ++k) {
      const std::vector<float> o = RandomObservation(74, 100 + k);
      inputs.append(reinterpret_cast<const char*>(o.data()), o.size() * sizeof(float));
      float action[3];
      policy.Mean(o.data(), action);
      expected.insert(expected.end(), action, action + 3);
    }
    Write(Path("in"), inputs);
    Write(Path("read.py"),
          "import sys, cv2, numpy as np\n"
          "net = cv2.dnn.readNetFromONNX(sys.argv[1])\n"
          "out = []\n"
          "for row in np.fromfile(sys.argv[2], np.float32).reshape(-1, 74):\n"
          "    net.setInput(row.reshape(1, 74))\n"
          "    out.append(net.forward().reshape(-1).copy())\n"
          "np.array(out, np.float32).tofile(sys.argv[3])\n");
    const std::string command = "/usr/bin/python3 " + Path("read.py") + " " + Path("p.onnx") + " " +
                                Path("in") + " " + Path("out");
    ASSERT_EQ(std::system(command.c_str()), 0) << "python3-opencv could not read the file";
    const std::string bytes = Bytes(Path("out"));
    ASSERT_EQ(bytes.size(), expected.size() * sizeof(float));
    std::vector<float> actual(expected.size());
    std::memcpy(actual.data(), bytes.data(), bytes.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(actual[i], expected[i], 1e-5);
  }
}

TEST_F(PolicyTest, MeanAllocatesNothingAndTakesLessThanTenMicroseconds) {
  const Policy policy(RandomParameters({74, 64, 64, 3}, Policy::Activation::kTanh, 2));
  const std::vector<float> o = RandomObservation(74, 1);
  float action[3];
  const long before = allocations;
  double best = 1e9;
  for (int repeat = 0; repeat < 20; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 500; ++i) policy.Mean(o.data(), action);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    best = std::min(best, took.count() / 500);
  }
  EXPECT_EQ(allocations, before);
  EXPECT_LT(best, 10e-6);
  RecordProperty("microseconds", std::to_string(best * 1e6));
  std::free(std::malloc(1));
  EXPECT_GT(allocations, before) << "the counter does not count";
}

TEST_F(PolicyTest, ThreadsAndCopiesGetTheSameBits) {
  const Policy policy(RandomParameters({74, 64, 64, 3}, Policy::Activation::kTanh, 2));
  // A buffer one float off any alignment must not change the sum's order.
  std::vector<float> storage = RandomObservation(75, 1);
  float expected[3], shifted[4];
  const std::vector<float> aligned(storage.begin() + 1, storage.end());
  policy.Mean(aligned.data(), expected);
  policy.Mean(storage.data() + 1, shifted + 1);
  EXPECT_EQ(std::memcmp(expected, shifted + 1, sizeof expected), 0);
  const Policy copy = policy;
  float other[3];
  std::thread([&] { copy.Mean(aligned.data(), other); }).join();
  EXPECT_EQ(std::memcmp(expected, other, sizeof expected), 0);
}

TEST_F(PolicyTest, RefusesWhatIsNotAPolicyFile) {
  ExpectFileRefused(Path("missing.onnx"), "no such");
  ExpectFileRefused(folder_.string(), "regular file");
  Write(Path("empty.onnx"), "");
  ExpectFileRefused(Path("empty.onnx"), "not a policy");
  Write(Path("text.onnx"), "input_mean: 1\n");
  ExpectFileRefused(Path("text.onnx"), "not a policy");
  std::string noise(10000, '\0');
  std::mt19937 rng(1);
  for (char& c : noise) c = static_cast<char>(rng());
  Write(Path("noise.onnx"), noise);
  ExpectFileRefused(Path("noise.onnx"), "not a policy");
  Write(Path("huge.onnx"), "");
  ASSERT_EQ(truncate(Path("huge.onnx").c_str(), Policy::kMaxFileBytes + 1), 0);
  ExpectFileRefused(Path("huge.onnx"), "larger");
}

TEST_F(PolicyTest, RefusesEveryTruncation) {
  Policy(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1)).SaveOnnx(Path("good.onnx"));
  const std::string bytes = Bytes(Path("good.onnx"));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Write(Path("cut.onnx"), bytes.substr(0, size));
    EXPECT_THROW(Policy::LoadOnnx(Path("cut.onnx")), UserError) << size << " of " << bytes.size();
  }
}

TEST_F(PolicyTest, ChangedBytesNeverCrashAndNeverChangeTheNumbers) {
  const Policy good(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1));
  good.SaveOnnx(Path("good.onnx"));
  const std::string bytes = Bytes(Path("good.onnx"));
  std::mt19937 rng(1);
  for (int k = 0; k < 1000; ++k) {
    std::string changed = bytes;
    changed[rng() % changed.size()] = static_cast<char>(rng());
    Write(Path("changed.onnx"), changed);
    try {
      const Policy read = Policy::LoadOnnx(Path("changed.onnx"));
      const std::vector<float> o = RandomObservation(6, 1);
      float a[3], b[3];
      good.Mean(o.data(), a);
      read.Mean(o.data(), b);
      EXPECT_EQ(std::memcmp(a, b, sizeof a), 0) << k;
    } catch (const UserError&) {
    }
  }
}

TEST_F(PolicyTest, RefusesOtherGraphs) {
  using Model = onnx::ModelProto*;
  ExpectRefused([](Model m) { m->mutable_graph()->mutable_node(3)->set_op_type("MatMul"); },
                "not Gemm");
  ExpectRefused([](Model m) { m->mutable_graph()->mutable_node(4)->set_op_type("Sigmoid"); },
                "not Tanh or Relu");
  ExpectRefused([](Model m) { m->mutable_graph()->mutable_node(3)->set_domain("custom"); },
                "not Gemm");
  ExpectRefused([](Model m) { m->mutable_graph()->mutable_node(3)->set_input(0, "observation"); },
                "does not continue");
  ExpectRefused(
      [](Model m) { m->mutable_graph()->mutable_node(3)->mutable_attribute(3)->set_i(0); },
      "Gemm is not");
  ExpectRefused(
      [](Model m) {
        onnx::AttributeProto* a = m->mutable_graph()->mutable_node(4)->add_attribute();
        a->set_name("body");
        a->set_type(onnx::AttributeProto::GRAPH);
      },
      "attribute 'body'");
  ExpectRefused([](Model m) { m->mutable_graph()->add_node()->set_op_type("Loop"); },
                "operators after Mul");
  ExpectRefused([](Model m) { m->mutable_opset_import(0)->set_version(13); }, "operator set");
  ExpectRefused([](Model m) { m->add_functions(); }, "functions");
  ExpectRefused([](Model m) { m->clear_graph(); }, "no graph");
  ExpectRefused(
      [](Model m) {
        for (int i = 0; i < 40; ++i) m->mutable_graph()->add_node()->set_op_type("Tanh");
      },
      "too many");
}

TEST_F(PolicyTest, RefusesBadConstants) {
  using Model = onnx::ModelProto*;
  const auto tensor = [](Model m, int i) { return m->mutable_graph()->mutable_initializer(i); };
  ExpectRefused([&](Model m) { tensor(m, 2)->set_dims(0, 5); }, "another size");
  ExpectRefused([&](Model m) { tensor(m, 2)->set_dims(0, -1); }, "dimension of -1");
  ExpectRefused([&](Model m) { tensor(m, 2)->set_dims(0, 1LL << 40); }, "dimension of");
  ExpectRefused([&](Model m) { tensor(m, 2)->set_data_type(onnx::TensorProto::DOUBLE); },
                "not float32");
  ExpectRefused(
      [&](Model m) {
        tensor(m, 2)->set_data_location(onnx::TensorProto::EXTERNAL);
        onnx::StringStringEntryProto* e = tensor(m, 2)->add_external_data();
        e->set_key("location");
        e->set_value("/etc/passwd");
      },
      "outside the file");
  ExpectRefused(
      [&](Model m) {
        const float nan = std::numeric_limits<float>::quiet_NaN();
        std::memcpy(tensor(m, 2)->mutable_raw_data()->data(), &nan, sizeof nan);
      },
      "not finite");
  ExpectRefused([&](Model m) { tensor(m, 2)->mutable_raw_data()->data()[1] ^= 1; }, "checksum");
  ExpectRefused([&](Model m) { tensor(m, 2)->set_name("other"); }, "not a constant");
  ExpectRefused([&](Model m) { *m->mutable_graph()->add_initializer() = *tensor(m, 0); },
                "defined twice");
  ExpectRefused([](Model m) { m->mutable_metadata_props(3)->set_value("0.5"); }, "action scale");
  ExpectRefused([](Model m) { m->mutable_metadata_props(3)->set_value("nan"); }, "not a number");
}

TEST_F(PolicyTest, ConstructorChecksShapesAndNumbers) {
  const auto bad = [](const std::function<void(Policy::Parameters*)>& change) {
    Policy::Parameters p = RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1);
    change(&p);
    EXPECT_THROW(Policy{p}, UserError);
  };
  bad([](auto* p) { p->layers[1].weight.resize(3, 5); });
  bad([](auto* p) { p->layers[0].bias.resize(3); });
  bad([](auto* p) { p->input_std.resize(5); });
  bad([](auto* p) { p->input_std[0] = -1.0F; });
  bad([](auto* p) { p->layers.clear(); });
  bad([](auto* p) { p->log_std.resize(1); });
  bad([](auto* p) { p->layers[0].weight(0, 0) = INFINITY; });
  bad([](auto* p) { p->layers[0].weight.setConstant(3e38F); });
  bad([](auto* p) { p->log_std(0) = 100.0F; });
  bad([](auto* p) { p->metadata.action_scale = 1.5; });
  bad([](auto* p) {
    const Policy::Layer square{Eigen::MatrixXf::Zero(4, 4), Eigen::VectorXf::Zero(4)};
    p->layers.insert(p->layers.begin() + 1, 8, square);
  });
}

TEST_F(PolicyTest, FitsOnlyTheScenarioItWasMadeFor) {
  Scenario scenario;
  const Policy policy(RandomParameters({74, 8, 3}, Policy::Activation::kTanh, 1));
  EXPECT_NO_THROW(policy.RequireFits(scenario));
  scenario.observation.graph = false;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
  scenario = Scenario();
  scenario.observation.order = NeighbourOrder::kIndex;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
  scenario = Scenario();
  scenario.control.interface = ActionInterface::kTau6;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
}

}  // namespace
}  // namespace stg
