#include <onnx/onnx_pb.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "policy_onnx.hpp"

/// Reads policy files: one known chain of operators. Everything is checked.
namespace stg::agent {
namespace {

/// Every error names the file.
class Reader {
 public:
  Reader(std::string path, const onnx::ModelProto& model)
      : path_(std::move(path)), model_(model), graph_(model.graph()) {}

  Policy::Parameters Read() {
    CheckModel();
    IndexConstants();
    ReadMetadata();
    ReadChain();
    Require(used_ == constants_.size(), "has constants that no operator uses");
    const auto checksum = properties_.find("stg.checksum");
    Require(checksum != properties_.end() &&
                (checksum->second == PolicyChecksum(p_) || checksum->second == NumbersChecksum(p_)),
            "is damaged: its checksum does not match");
    return std::move(p_);
  }

 private:
  [[noreturn]] void Fail(const std::string& what) const {
    throw UserError(path_ + ": not a policy: " + what);
  }
  void Require(bool ok, const std::string& what) const {
    if (!ok) Fail(what);
  }

  void CheckModel() const {
    Require(model_.has_graph() && graph_.node_size() > 0, "has no graph");
    Require(model_.functions_size() == 0 && model_.training_info_size() == 0 &&
                graph_.sparse_initializer_size() == 0,
            "has functions, training information or sparse constants");
    Require(model_.opset_import_size() == 1 && model_.opset_import(0).domain().empty() &&
                (model_.opset_import(0).version() == 9 || model_.opset_import(0).version() == 10),
            "operator set is not 9 or 10");
    Require(graph_.input_size() == 1 && graph_.output_size() == 1,
            "has not exactly one input and one output");
    Require(graph_.node_size() <= 7 + 2 * Policy::kMaxLayers, "has too many operators");
  }

  void IndexConstants() {
    for (const onnx::TensorProto& tensor : graph_.initializer()) {
      Require(constants_.emplace(tensor.name(), &tensor).second,
              "constant '" + tensor.name() + "' is defined twice");
    }
  }

  /// Numbers and shape of the constant that is input `index` of the node.
  std::vector<float> Constant(const onnx::NodeProto& node, int index,
                              std::vector<std::int64_t>* dims) {
    const auto found = constants_.find(node.input(index));
    Require(found != constants_.end(),
            node.op_type() + " reads '" + node.input(index) + "', which is not a constant");
    ++used_;
    const onnx::TensorProto& tensor = *found->second;
    const std::string name = "constant '" + tensor.name() + "' ";
    Require(!tensor.has_data_location() || tensor.data_location() == onnx::TensorProto::DEFAULT,
            name + "is stored outside the file");
    Require(tensor.external_data_size() == 0, name + "is stored outside the file");
    Require(tensor.data_type() == onnx::TensorProto::FLOAT, name + "is not float32");
    Require(!tensor.has_segment(), name + "is split");
    Require(tensor.dims_size() <= 2, name + "has more than two dimensions");
    std::size_t count = 1;
    dims->clear();
    for (const std::int64_t d : tensor.dims()) {
      Require(d >= 1 && d <= Policy::kMaxWidth, name + "has a dimension of " + std::to_string(d));
      dims->push_back(d);
      count *= static_cast<std::size_t>(d);
    }
    std::vector<float> data(count);
    if (tensor.has_raw_data()) {
      Require(tensor.float_data_size() == 0 && tensor.raw_data().size() == count * sizeof(float),
              name + "has another size than its shape says");
      std::memcpy(data.data(), tensor.raw_data().data(), count * sizeof(float));
    } else {
      Require(static_cast<std::size_t>(tensor.float_data_size()) == count,
              name + "has another size than its shape says");
      std::copy(tensor.float_data().begin(), tensor.float_data().end(), data.begin());
    }
    for (const float x : data) Require(std::isfinite(x), name + "is not finite");
    return data;
  }

  Eigen::VectorXf Vector(const onnx::NodeProto& node, int index) {
    std::vector<std::int64_t> dims;
    const std::vector<float> data = Constant(node, index, &dims);
    Require(dims.size() == 1 || (dims.size() == 2 && dims[0] == 1),
            "constant '" + node.input(index) + "' is not a vector");
    return Eigen::Map<const Eigen::VectorXf>(data.data(), static_cast<Eigen::Index>(data.size()));
  }

  /// The next operator. It must continue the chain and have `inputs` inputs.
  /// @param from input that continues the chain.
  const onnx::NodeProto& Next(const char* op, int inputs, int from = 0) {
    Require(next_ < graph_.node_size(), std::string("ends where ") + op + " is expected");
    const onnx::NodeProto& node = graph_.node(next_++);
    Require(node.op_type() == op && node.domain().empty(),
            "operator " + std::to_string(next_) + " is '" + node.op_type() + "', not " + op);
    Require(node.input_size() == inputs && node.output_size() == 1 && node.input(from) == last_,
            node.op_type() + " does not continue the chain");
    Require(!node.output(0).empty() && constants_.count(node.output(0)) == 0,
            node.op_type() + " overwrites a constant");
    last_ = node.output(0);
    return node;
  }

  /// Attributes of the node by name. Fails for any attribute that is not in `allowed`.
  std::map<std::string, double> Attributes(const onnx::NodeProto& node,
                                           std::map<std::string, double> allowed) const {
    for (const onnx::AttributeProto& a : node.attribute()) {
      Require(allowed.count(a.name()) == 1,
              node.op_type() + " has the attribute '" + a.name() + "'");
      if (a.type() == onnx::AttributeProto::FLOAT) {
        allowed[a.name()] = a.f();
      } else if (a.type() == onnx::AttributeProto::INT) {
        allowed[a.name()] = static_cast<double>(a.i());
      } else {
        Fail(node.op_type() + "'s attribute '" + a.name() + "' is not a number");
      }
    }
    return allowed;
  }

  void ReadChain() {
    last_ = graph_.input(0).name();
    const onnx::NodeProto& sub = Next("Sub", 2);
    Attributes(sub, {});
    p_.input_mean = Vector(sub, 1);
    const onnx::NodeProto& div = Next("Div", 2);
    Attributes(div, {});
    p_.input_std = Vector(div, 1);
    const auto bounds = Attributes(Next("Clip", 1), {{"min", std::nan("")}, {"max", std::nan("")}});
    p_.input_clip = static_cast<float>(bounds.at("max"));
    Require(bounds.at("min") == -bounds.at("max"), "Clip's bounds are not symmetric");

    bool done = false;
    while (!done) {
      ReadGemm();
      Require(next_ < graph_.node_size(), "ends without an activation");
      const std::string op = graph_.node(next_).op_type();
      if (op == "Reshape") {
        ReadChoice();
        break;
      }
      Require(op == "Tanh" || op == "Relu", "operator " + op + " is not Tanh or Relu");
      Attributes(Next(op.c_str(), 1), {});
      const bool relu = op == "Relu";
      done = next_ < graph_.node_size() && graph_.node(next_).op_type() == "Mul";
      if (done) {
        Require(!relu, "the last activation is not Tanh");
      } else {
        const auto activation = relu ? Policy::Activation::kRelu : Policy::Activation::kTanh;
        Require(p_.layers.size() == 1 || activation == p_.activation, "mixes hidden activations");
        p_.activation = activation;
      }
    }
    const onnx::NodeProto& mul = Next("Mul", 2);
    Attributes(mul, {});
    const Eigen::VectorXf scale = Vector(mul, 1);
    Require((scale.array() == static_cast<float>(p_.metadata.action_scale)).all() &&
                (scale.size() == 1 || scale.size() == p_.log_std.size()),
            "Mul is not by the stated action scale");
    Require(next_ == graph_.node_size() && last_ == graph_.output(0).name(),
            "has operators after Mul");
  }

  /// Reads the operators after the last layer of a Q-network.
  void ReadChoice() {
    const onnx::NodeProto& reshape = Next("Reshape", 2);
    Attributes(reshape, {});
    const auto found = constants_.find(reshape.input(1));
    Require(found != constants_.end(), "Reshape's shape is not a constant");
    ++used_;
    const onnx::TensorProto& shape = *found->second;
    Require(shape.data_type() == onnx::TensorProto::INT64 && shape.dims_size() == 1 &&
                shape.dims(0) == 3 && shape.int64_data_size() == 3 && !shape.has_raw_data() &&
                !shape.has_segment() && shape.external_data_size() == 0,
            "Reshape's shape is not a list of three numbers");
    const auto best = Attributes(Next("ArgMax", 1), {{"axis", 0.0}, {"keepdims", 1.0}});
    Require(best.at("axis") == 2.0 && best.at("keepdims") == 0.0, "ArgMax is not over the choices");
    const onnx::NodeProto& gather = Next("Gather", 2, 1);
    Require(Attributes(gather, {{"axis", 0.0}}).at("axis") == 0.0, "Gather is not by row");
    std::vector<std::int64_t> dims;
    const std::vector<float> data = Constant(gather, 0, &dims);
    Require(dims.size() == 2, "the choices are not a matrix");
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    p_.choices = Eigen::Map<const RowMajor>(data.data(), dims[0], dims[1]);
    Require(shape.int64_data(0) == 1 && shape.int64_data(2) == dims[0] &&
                shape.int64_data(1) >= 1 && shape.int64_data(1) <= Policy::kMaxWidth &&
                shape.int64_data(1) * dims[0] == p_.layers.back().bias.size(),
            "Reshape is not to heads and choices");
    Require(Attributes(Next("Flatten", 1), {{"axis", 1.0}}).at("axis") == 1.0,
            "Flatten is not to one row");
  }

  void ReadGemm() {
    const onnx::NodeProto& gemm = Next("Gemm", 3);
    const auto a =
        Attributes(gemm, {{"alpha", 1.0}, {"beta", 1.0}, {"transA", 0.0}, {"transB", 0.0}});
    Require(a.at("alpha") == 1.0 && a.at("beta") == 1.0 && a.at("transA") == 0.0 &&
                a.at("transB") == 1.0,
            "Gemm is not x W^T + b");
    Require(p_.layers.size() < Policy::kMaxLayers, "has too many layers");
    std::vector<std::int64_t> dims;
    const std::vector<float> data = Constant(gemm, 1, &dims);
    Require(dims.size() == 2, "Gemm's weight is not a matrix");
    using RowMajor = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Policy::Layer layer;
    layer.weight = Eigen::Map<const RowMajor>(data.data(), dims[0], dims[1]);
    layer.bias = Vector(gemm, 2);
    p_.layers.push_back(std::move(layer));
  }

  const std::string& Property(const std::string& key) const {
    const auto found = properties_.find(key);
    Require(found != properties_.end(), "metadata '" + key + "' is missing");
    return found->second;
  }

  double Number(const std::string& key) const {
    const std::string& text = Property(key);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    Require(!text.empty() && *end == '\0' && std::isfinite(value),
            "metadata '" + key + "' is not a number");
    return value;
  }

  void ReadMetadata() {
    Require(model_.metadata_props_size() <= 1000, "has too much metadata");
    for (const auto& entry : model_.metadata_props()) {
      Require(entry.value().size() <= 65536, "has too much metadata");
      Require(IsText(entry.key()) && IsText(entry.value()), "metadata that is not text");
      Require(properties_.emplace(entry.key(), entry.value()).second,
              "metadata '" + entry.key() + "' is given twice");
    }
    PolicyMetadata& m = p_.metadata;
    m.id = Property("stg.id");
    m.observation_layout = Property("stg.observation_layout");
    m.action_interface = Property("stg.action_interface");
    m.action_scale = Number("stg.action_scale");
    m.scenario_hash = Property("stg.scenario_hash");
    const double step = Number("stg.training_step");
    Require(std::abs(step) <= 9e15, "metadata 'stg.training_step' is out of range");
    m.training_step = static_cast<std::int64_t>(step);
    Number("stg.seed");
    m.seed = std::strtoull(Property("stg.seed").c_str(), nullptr, 10);
    const std::size_t prefix = std::strlen(kMetricPrefix);
    for (const auto& [key, value] : properties_) {
      if (key.compare(0, prefix, kMetricPrefix) == 0) m.metrics[key.substr(prefix)] = value;
    }
    std::vector<float> log_std;
    const std::string& text = Property("stg.log_std");
    const char* at = text.c_str();
    while (*at != '\0' && log_std.size() <= Policy::kMaxWidth) {
      char* end = nullptr;
      log_std.push_back(std::strtof(at, &end));
      Require(end != at, "metadata 'stg.log_std' is not a list of numbers");
      at = end;
    }
    p_.log_std =
        Eigen::Map<Eigen::VectorXf>(log_std.data(), static_cast<Eigen::Index>(log_std.size()));
  }

  const std::string path_;
  const onnx::ModelProto& model_;
  const onnx::GraphProto& graph_;
  std::map<std::string, const onnx::TensorProto*> constants_;
  std::map<std::string, std::string> properties_;
  Policy::Parameters p_;
  std::string last_;
  int next_ = 0;
  std::size_t used_ = 0;
};

}  // namespace

onnx::ModelProto ReadModel(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) throw UserError(path + ": no such policy file");
  if (!S_ISREG(info.st_mode)) throw UserError(path + ": not a policy: not a regular file");
  if (info.st_size > Policy::kMaxFileBytes) {
    throw UserError(path + ": not a policy: larger than " + std::to_string(Policy::kMaxFileBytes) +
                    " bytes");
  }
  std::string bytes(static_cast<std::size_t>(info.st_size), '\0');
  std::ifstream in(path, std::ios::binary);
  if (!in || !in.read(bytes.data(), static_cast<std::streamsize>(bytes.size()))) {
    throw UserError(path + ": cannot read the policy");
  }
  onnx::ModelProto model;
  if (bytes.empty() || !model.ParseFromArray(bytes.data(), static_cast<int>(bytes.size()))) {
    throw UserError(path + ": not a policy: not an ONNX file, or a truncated one");
  }
  return model;
}

Policy Policy::LoadOnnx(const std::string& path) {
  const onnx::ModelProto model = ReadModel(path);
  try {
    return Policy(Reader(path, model).Read());
  } catch (const UserError& error) {
    const std::string what = error.what();
    if (what.compare(0, path.size(), path) == 0) throw;
    throw UserError(path + ": " + what);
  }
}

}  // namespace stg::agent
