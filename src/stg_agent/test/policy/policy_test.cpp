#include <gtest/gtest.h>
#include <onnx/checker.h>
#include <onnx/onnx_pb.h>

#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "auv_common/error.hpp"
#include "policy/policy_files.hpp"

namespace {
std::atomic<long> allocations{0};
}
// Eigen allocates with malloc, so the test counts calls of malloc and not of operator new.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
// A sanitizer has its own malloc, which runs before ours could.
extern "C" void __sanitizer_malloc_hook(const volatile void*, std::size_t) { ++allocations; }
#else
extern "C" void* __libc_malloc(std::size_t);
extern "C" void* malloc(std::size_t size) {
  ++allocations;
  return __libc_malloc(size);
}
#endif

namespace stg::agent {
namespace {

/// The definition of a policy in double precision, without the class under test.
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

TEST_F(PolicyTest, MeanAllocatesNothing) {
  const Policy policy(RandomParameters({74, 64, 64, 3}, Policy::Activation::kTanh, 2));
  const std::vector<float> o = RandomObservation(74, 1);
  float action[3];
  const long before = allocations;
  for (int i = 0; i < 500; ++i) policy.Mean(o.data(), action);
  EXPECT_EQ(allocations, before);
  void* volatile kept = std::malloc(1);  // volatile: else the compiler drops it
  std::free(kept);
  EXPECT_GT(allocations, before) << "the counter does not count";
}

TEST_F(PolicyTest, ThreadsAndCopiesGetTheSameBits) {
  const Policy policy(RandomParameters({74, 64, 64, 3}, Policy::Activation::kTanh, 2));
  // The buffer is one float off any alignment. This must not change the order of the sum.
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
  AgentModel scenario;
  const Policy policy(RandomParameters({74, 8, 3}, Policy::Activation::kTanh, 1));
  EXPECT_NO_THROW(policy.RequireFits(scenario));
  scenario.observation.graph = false;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
  scenario = AgentModel();
  scenario.observation.order = NeighbourOrder::kIndex;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
  scenario = AgentModel();
  scenario.control.interface = dynamics::ActionInterface::kTau6;
  EXPECT_THROW(policy.RequireFits(scenario), UserError);
}

}  // namespace
}  // namespace stg::agent
