#include "policy_onnx.hpp"

#include <onnx/onnx_pb.h>

#include <cinttypes>
#include <cstdio>
#include <utility>

#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"

/// Writes policy files. Operator set 10 is the last one whose Clip has its bounds as attributes,
/// which old readers such as OpenCV 4.6 understand.
namespace stg::agent {
namespace {

constexpr int kOpset = 10;
constexpr int kIrVersion = 5;

std::string Text(double value, int digits) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

/// Appends nodes. Each node reads the output of the previous one.
class ChainWriter {
 public:
  ChainWriter(onnx::GraphProto* graph, std::string input)
      : graph_(graph), last_(std::move(input)) {}

  onnx::NodeProto* Add(const char* op, const std::string& output) {
    onnx::NodeProto* node = graph_->add_node();
    node->set_op_type(op);
    node->set_name(output);
    node->add_input(last_);
    node->add_output(output);
    last_ = output;
    return node;
  }

  /// Adds a constant [dims] as the node's next input; `data` is row-major.
  void AddConstant(onnx::NodeProto* node, const std::string& name,
                   const std::vector<std::int64_t>& dims, const float* data) {
    onnx::TensorProto* tensor = graph_->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::FLOAT);
    std::size_t count = 1;
    for (const std::int64_t d : dims) {
      tensor->add_dims(d);
      count *= static_cast<std::size_t>(d);
    }
    tensor->set_raw_data(data, count * sizeof(float));
    node->add_input(name);
  }

  /// Adds a constant list of integers as the node's next input.
  void AddShape(onnx::NodeProto* node, const std::string& name,
                const std::vector<std::int64_t>& shape) {
    onnx::TensorProto* tensor = graph_->add_initializer();
    tensor->set_name(name);
    tensor->set_data_type(onnx::TensorProto::INT64);
    tensor->add_dims(static_cast<std::int64_t>(shape.size()));
    for (const std::int64_t d : shape) tensor->add_int64_data(d);
    node->add_input(name);
  }

 private:
  onnx::GraphProto* graph_;
  std::string last_;
};

void SetFloat(onnx::NodeProto* node, const char* name, float value) {
  onnx::AttributeProto* attribute = node->add_attribute();
  attribute->set_name(name);
  attribute->set_type(onnx::AttributeProto::FLOAT);
  attribute->set_f(value);
}

void SetInt(onnx::NodeProto* node, const char* name, std::int64_t value) {
  onnx::AttributeProto* attribute = node->add_attribute();
  attribute->set_name(name);
  attribute->set_type(onnx::AttributeProto::INT);
  attribute->set_i(value);
}

void SetValueInfo(onnx::ValueInfoProto* info, const char* name, int size) {
  info->set_name(name);
  onnx::TypeProto::Tensor* type = info->mutable_type()->mutable_tensor_type();
  type->set_elem_type(onnx::TensorProto::FLOAT);
  type->mutable_shape()->add_dim()->set_dim_value(1);
  type->mutable_shape()->add_dim()->set_dim_value(size);
}

/// The operators after the last layer of a Q-network: the choice of each head, and its action.
void WriteChoice(const Policy::Parameters& p, ChainWriter* chain) {
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const std::int64_t count = p.choices.rows();
  chain->AddShape(chain->Add("Reshape", "values"), "heads",
                  {1, p.layers.back().bias.size() / count, count});
  onnx::NodeProto* best = chain->Add("ArgMax", "best");
  SetInt(best, "axis", 2);
  SetInt(best, "keepdims", 0);
  const RowMajor choices = p.choices;
  onnx::NodeProto* gather = chain->Add("Gather", "chosen");
  chain->AddConstant(gather, "choices", {choices.rows(), choices.cols()}, choices.data());
  gather->mutable_input()->SwapElements(0, 1);  // Gather needs the data first
  SetInt(gather, "axis", 0);
  SetInt(chain->Add("Flatten", "unscaled"), "axis", 1);
}

void AddProperty(onnx::ModelProto* model, const std::string& key, const std::string& value) {
  onnx::StringStringEntryProto* entry = model->add_metadata_props();
  entry->set_key(key);
  entry->set_value(value);
}

void WriteMetadata(const Policy::Parameters& p, onnx::ModelProto* model) {
  const PolicyMetadata& m = p.metadata;
  AddProperty(model, "stg.id", m.id);
  AddProperty(model, "stg.observation_layout", m.observation_layout);
  AddProperty(model, "stg.action_interface", m.action_interface);
  AddProperty(model, "stg.action_scale", Text(m.action_scale, 17));
  AddProperty(model, "stg.scenario_hash", m.scenario_hash);
  AddProperty(model, "stg.training_step", std::to_string(m.training_step));
  AddProperty(model, "stg.seed", std::to_string(m.seed));
  std::string log_std;
  for (Eigen::Index i = 0; i < p.log_std.size(); ++i) {
    log_std += (i == 0 ? "" : " ") + Text(p.log_std[i], 9);
  }
  AddProperty(model, "stg.log_std", log_std);
  for (const auto& [name, value] : m.metrics) AddProperty(model, kMetricPrefix + name, value);
  AddProperty(model, "stg.checksum", PolicyChecksum(p));
}

/// FNV-1a, 64 bits.
class Fnv {
 public:
  void Add(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash_ = (hash_ ^ bytes[i]) * 1099511628211ULL;
  }
  /// Adds the end of the text, too, so that two texts cannot be confused with one.
  void Add(const std::string& text) { Add(text.c_str(), text.size() + 1); }
  void Add(const float* data, Eigen::Index count) {
    Add(static_cast<const void*>(data), static_cast<std::size_t>(count) * sizeof(float));
  }
  /// All numbers of a policy.
  void Add(const Policy::Parameters& p) {
    Add(p.input_mean.data(), p.input_mean.size());
    Add(p.input_std.data(), p.input_std.size());
    Add(&p.input_clip, 1);
    for (const Policy::Layer& layer : p.layers) {
      Add(layer.weight.data(), layer.weight.size());
      Add(layer.bias.data(), layer.bias.size());
    }
    Add(p.log_std.data(), p.log_std.size());
    if (p.choices.size() > 0) {
      Add(p.choices.data(), p.choices.size());
      const auto width = static_cast<float>(p.choices.cols());
      Add(&width, 1);
    }
    const float rest[] = {static_cast<float>(p.activation),
                          static_cast<float>(p.metadata.action_scale)};
    Add(rest, 2);
  }
  std::string Text() const {
    char text[17];
    std::snprintf(text, sizeof text, "%016" PRIx64, hash_);
    return text;
  }

 private:
  std::uint64_t hash_ = 14695981039346656037ULL;
};

}  // namespace

std::string NumbersChecksum(const Policy::Parameters& p) {
  Fnv hash;
  hash.Add(p);
  return hash.Text();
}

std::string PolicyChecksum(const Policy::Parameters& p) {
  const PolicyMetadata& m = p.metadata;
  Fnv hash;
  hash.Add(p);
  for (const std::string* text :
       {&m.id, &m.observation_layout, &m.action_interface, &m.scenario_hash}) {
    hash.Add(*text);
  }
  hash.Add(Text(m.action_scale, 17));
  hash.Add(std::to_string(m.training_step));
  hash.Add(std::to_string(m.seed));
  for (const auto& [name, value] : m.metrics) {
    hash.Add(name);
    hash.Add(value);
  }
  return "2:" + hash.Text();
}

void Policy::SaveOnnx(const std::string& path) const {
  const Parameters& p = parameters_;
  onnx::ModelProto model;
  model.set_ir_version(kIrVersion);
  model.set_producer_name("stg");
  model.add_opset_import()->set_version(kOpset);
  onnx::GraphProto* graph = model.mutable_graph();
  graph->set_name("policy");
  SetValueInfo(graph->add_input(), "observation", observation_size());
  SetValueInfo(graph->add_output(), "action", action_size());

  ChainWriter chain(graph, "observation");
  chain.AddConstant(chain.Add("Sub", "centred"), "input_mean", {1, observation_size()},
                    p.input_mean.data());
  chain.AddConstant(chain.Add("Div", "scaled"), "input_std", {1, observation_size()},
                    p.input_std.data());
  onnx::NodeProto* clip = chain.Add("Clip", "clipped");
  SetFloat(clip, "min", -p.input_clip);
  SetFloat(clip, "max", p.input_clip);
  using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  for (std::size_t l = 0; l < p.layers.size(); ++l) {
    const std::string n = std::to_string(l);
    const RowMajor weight = p.layers[l].weight;
    onnx::NodeProto* gemm = chain.Add("Gemm", "sum" + n);
    chain.AddConstant(gemm, "weight" + n, {weight.rows(), weight.cols()}, weight.data());
    chain.AddConstant(gemm, "bias" + n, {weight.rows()}, p.layers[l].bias.data());
    SetFloat(gemm, "alpha", 1.0F);
    SetFloat(gemm, "beta", 1.0F);
    SetInt(gemm, "transA", 0);
    SetInt(gemm, "transB", 1);
    if (l + 1 == p.layers.size() && p.choices.size() > 0) {
      WriteChoice(p, &chain);
      break;
    }
    const bool tanh = l + 1 == p.layers.size() || p.activation == Activation::kTanh;
    chain.Add(tanh ? "Tanh" : "Relu", "hidden" + n);
  }
  const Eigen::VectorXf scale =
      Eigen::VectorXf::Constant(action_size(), static_cast<float>(p.metadata.action_scale));
  chain.AddConstant(chain.Add("Mul", "action"), "action_scale", {1, action_size()}, scale.data());
  WriteMetadata(p, &model);

  std::string bytes;
  if (!model.SerializeToString(&bytes)) throw UserError(path + ": cannot write the policy");
  WriteDurably(bytes, path, "the policy");
}

}  // namespace stg::agent
