// A file that is no policy, or a spoiled one, is refused. The message has its name and the reason.

#include <gtest/gtest.h>
#include <onnx/onnx_pb.h>
#include <unistd.h>

#include <cstring>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "auv_common/error.hpp"
#include "policy/policy_files.hpp"
#include "policy/policy_onnx.hpp"

namespace stg::agent {
namespace {

class PolicyRefusal : public PolicyTest {
 protected:
  /// Saves a good policy and lets `change` spoil the model. Expects a refusal that names the file
  /// and contains `reason`.
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
};

TEST_F(PolicyRefusal, RefusesWhatIsNotAPolicyFile) {
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

TEST_F(PolicyRefusal, RefusesEveryTruncation) {
  Policy(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1)).SaveOnnx(Path("good.onnx"));
  const std::string bytes = Bytes(Path("good.onnx"));
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    Write(Path("cut.onnx"), bytes.substr(0, size));
    EXPECT_THROW(Policy::LoadOnnx(Path("cut.onnx")), UserError) << size << " of " << bytes.size();
  }
}

TEST_F(PolicyRefusal, ChangedBytesNeverCrashAndNeverChangeTheNumbers) {
  const Policy good(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1));
  ExpectChangedBytesRefusedOrHarmless(good);
}

TEST_F(PolicyRefusal, RefusesOtherGraphs) {
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

TEST_F(PolicyRefusal, RefusesAFlippedBitAnywhereInTheMetadata) {
  Policy(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1)).SaveOnnx(Path("good.onnx"));
  onnx::ModelProto good;
  ASSERT_TRUE(good.ParseFromString(Bytes(Path("good.onnx"))));
  ASSERT_GE(good.metadata_props_size(), 9);
  for (int k = 0; k < good.metadata_props_size(); ++k) {
    const std::string& value = good.metadata_props(k).value();
    for (std::size_t i = 0; i < value.size(); ++i) {
      for (int bit = 0; bit < 8; bit += k == 0 ? 1 : 7) {
        onnx::ModelProto bad = good;
        std::string* text = bad.mutable_metadata_props(k)->mutable_value();
        (*text)[i] = static_cast<char>((*text)[i] ^ (1 << bit));
        Write(Path("bad.onnx"), bad.SerializeAsString());
        try {
          const Policy policy = Policy::LoadOnnx(Path("bad.onnx"));
          // A digit may differ where the number stays the same.
          EXPECT_EQ(policy.metadata().id, "test") << k << " " << i << " " << bit;
          EXPECT_EQ(policy.metadata().metrics.at("return"), "1040.5");
          EXPECT_TRUE(std::strpbrk(value.c_str(), "0123456789") != nullptr)
              << good.metadata_props(k).key() << " = " << *text;
        } catch (const UserError&) {
        }
      }
    }
  }
}

TEST_F(PolicyRefusal, RefusesMetadataThatIsNoTextOrThereTwice) {
  for (const char* text : {"\xff", "\xc3", "\xed\xa0\x80", "\xc0\xaf", "a\x01", "a\nb", "\x7f"}) {
    ExpectRefused([&](onnx::ModelProto* m) { m->mutable_metadata_props(0)->set_value(text); },
                  "not text");
  }
  ExpectRefused([](onnx::ModelProto* m) { *m->add_metadata_props() = m->metadata_props(0); },
                "twice");
}

TEST_F(PolicyRefusal, TakesTheChecksumOfOlderFiles) {
  // Version 0.1 wrote this checksum. It covers the numbers only, so any id is accepted.
  Policy(RandomParameters({6, 4, 3}, Policy::Activation::kTanh, 1)).SaveOnnx(Path("good.onnx"));
  onnx::ModelProto model;
  ASSERT_TRUE(model.ParseFromString(Bytes(Path("good.onnx"))));
  onnx::StringStringEntryProto* checksum = nullptr;
  for (auto& entry : *model.mutable_metadata_props()) {
    if (entry.key() == "stg.checksum") checksum = &entry;
  }
  ASSERT_NE(checksum, nullptr);
  checksum->set_value(NumbersChecksum(Policy::LoadOnnx(Path("good.onnx")).parameters()));
  Write(Path("old.onnx"), model.SerializeAsString());
  EXPECT_EQ(Policy::LoadOnnx(Path("old.onnx")).metadata().id, "test");
}

TEST_F(PolicyRefusal, RefusesBadConstants) {
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

}  // namespace
}  // namespace stg::agent
