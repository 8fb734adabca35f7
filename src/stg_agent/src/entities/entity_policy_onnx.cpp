#include <onnx/onnx_pb.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <utility>

#include "../policy/policy_onnx.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/durable_file.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "onnx_operators.hpp"
#include "stg_agent/entities/entity_policy.hpp"

/// Files of policies over entities. The reader takes the numbers from a file and builds the graph
/// that the writer would build from them. It refuses the file unless the file has exactly this
/// graph. So a file can never run code, and every shape is checked.
namespace stg::agent {
namespace {

constexpr int kEntityOpset = 10, kEntityIrVersion = 5;
constexpr char kEntityMetric[] = "stg.metric.";

std::string ExactText(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.9g", x);
  return text;
}

std::string BytesOf(const onnx::ModelProto& model) {
  std::string bytes;
  model.SerializeToString(&bytes);
  return bytes;
}

/// FNV-1a, 64 bits, which detects a damaged file.
std::string ChecksumOf(const std::string& bytes) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (const char c : bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

/// Writes the network of a policy.
std::vector<OnnxOperators::Held> WriteNetwork(const EntityPolicy::Parameters& p,
                                              onnx::GraphProto* graph) {
  graph->set_name("policy");
  OnnxOperators operators(graph, p.numbers);
  if (p.network == EntityNetwork::kGraph) {
    WriteGraph(EntityGraphSpec(CommandSize(p.action)), &operators);
  } else {
    WritePool(EntityActorSpec(CommandSize(p.action)), &operators);
  }
  return operators.held();
}

onnx::ModelProto ModelOf(const EntityPolicy::Parameters& p) {
  onnx::ModelProto model;
  model.set_ir_version(kEntityIrVersion);
  model.set_producer_name("stg");
  model.add_opset_import()->set_version(kEntityOpset);
  WriteNetwork(p, model.mutable_graph());
  const auto put = [&model](const std::string& key, const std::string& value) {
    onnx::StringStringEntryProto* entry = model.add_metadata_props();
    entry->set_key(key);
    entry->set_value(value);
  };
  const PolicyMetadata& m = p.metadata;
  put("stg.id", m.id);
  put("stg.observation_layout", kEntityLayout);
  put("stg.action_interface", EntityActionName(p.action));
  put("stg.action_scale", "1");
  if (p.network != EntityNetwork::kPool) put("stg.network", EntityNetworkName(p.network));
  put("stg.scenario_hash", m.scenario_hash);
  put("stg.training_step", std::to_string(m.training_step));
  put("stg.seed", std::to_string(m.seed));
  std::string log_std;
  for (const float s : p.log_std) {
    log_std += (log_std.empty() ? "" : " ") + ExactText(static_cast<double>(s));
  }
  put("stg.log_std", log_std);
  if (p.noise_time_s != 0.0) put("stg.noise_time_s", config::FormatNumber(p.noise_time_s));
  for (const auto& [name, value] : m.metrics) put(kEntityMetric + name, value);
  put("stg.checksum", "3:" + ChecksumOf(BytesOf(model)));
  return model;
}

/// Reads the numbers and the metadata of a file, and trusts nothing else in it.
class EntityReader {
 public:
  EntityReader(std::string path, const onnx::ModelProto& model)
      : path_(std::move(path)), model_(model) {}

  EntityPolicy::Parameters Read() {
    Require(model_.metadata_props_size() <= 1000, "has too much metadata");
    for (const auto& entry : model_.metadata_props()) {
      Require(entry.value().size() <= 65536 && IsText(entry.key()) && IsText(entry.value()),
              "metadata that is not text");
      Require(properties_.emplace(entry.key(), entry.value()).second,
              "metadata '" + entry.key() + "' is given twice");
    }
    EntityPolicy::Parameters p;
    Require(Property("stg.observation_layout") == kEntityLayout, "is of another layout");
    p.action = EntityActionNamed(Property("stg.action_interface"));
    // Older files have no such property, because there was only one network.
    if (properties_.count("stg.network") > 0) {
      p.network = EntityNetworkNamed(Property("stg.network"));
    }
    p.metadata.id = Property("stg.id");
    p.metadata.scenario_hash = Property("stg.scenario_hash");
    p.metadata.training_step = std::strtoll(Property("stg.training_step").c_str(), nullptr, 10);
    p.metadata.seed = std::strtoull(Property("stg.seed").c_str(), nullptr, 10);
    ReadDeviations(&p);
    for (const auto& [key, value] : properties_) {
      if (key.rfind(kEntityMetric, 0) == 0) {
        p.metadata.metrics[key.substr(std::strlen(kEntityMetric))] = value;
      }
    }
    ReadNumbers(&p);
    Require(BytesOf(ModelOf(p)) == BytesOf(model_),
            "the file is damaged, or its graph and its numbers do not fit together");
    return p;
  }

 private:
  void Require(bool ok, const std::string& what) const {
    if (!ok) throw UserError(path_ + ": not a policy: " + what);
  }
  const std::string& Property(const std::string& key) const {
    const auto found = properties_.find(key);
    Require(found != properties_.end(), "metadata '" + key + "' is missing");
    return found->second;
  }

  void ReadDeviations(EntityPolicy::Parameters* p) const {
    const std::string& text = Property("stg.log_std");
    const char* at = text.c_str();
    while (*at != '\0' && p->log_std.size() <= PoolNetwork::kMaxOutputs) {
      char* end = nullptr;
      p->log_std.push_back(std::strtof(at, &end));
      Require(end != at, "metadata 'stg.log_std' is not a list of numbers");
      at = end;
    }
    // Absent if the noise of every command is independent, as in older files.
    if (properties_.count("stg.noise_time_s") == 0) return;
    const std::string& time = Property("stg.noise_time_s");
    char* end = nullptr;
    p->noise_time_s = std::strtod(time.c_str(), &end);
    Require(end != time.c_str() && *end == '\0' && p->noise_time_s > 0.0 &&
                p->noise_time_s <= EntityPolicy::kMaxNoiseTime_s,
            "metadata 'stg.noise_time_s' is not a time from 0 to 10000 s");
  }

  /// The constants are in the order in which the writer writes them.
  void ReadNumbers(EntityPolicy::Parameters* p) const {
    p->numbers.assign(EntityParameters(p->network, CommandSize(p->action)), 0.0F);
    onnx::GraphProto written;
    const std::vector<OnnxOperators::Held> order = WriteNetwork(*p, &written);
    const onnx::GraphProto& graph = model_.graph();
    Require(graph.initializer_size() == static_cast<int>(order.size()),
            "has another number of constants");
    for (std::size_t k = 0; k < order.size(); ++k) {
      const onnx::TensorProto& tensor = graph.initializer(static_cast<int>(k));
      const PoolBlock& block = order[k].block;
      // The same in every file; the comparison of the graphs checks it.
      if (block.size() == 0) continue;
      const int rows = order[k].transposed ? block.cols : block.rows;
      const int cols = order[k].transposed ? block.rows : block.cols;
      Require(tensor.dims_size() == 2 && tensor.dims(0) == rows && tensor.dims(1) == cols &&
                  tensor.raw_data().size() == block.size() * sizeof(float),
              "constant '" + tensor.name() + "' has another shape");
      std::vector<float> data(block.size());
      std::memcpy(data.data(), tensor.raw_data().data(), tensor.raw_data().size());
      float* to = p->numbers.data() + block.offset;
      for (int r = 0; r < block.rows; ++r) {
        for (int c = 0; c < block.cols; ++c) {
          const int at = order[k].transposed ? c * block.rows + r : r * block.cols + c;
          *to++ = data[static_cast<std::size_t>(at)];
        }
      }
    }
  }

  std::string path_;
  const onnx::ModelProto& model_;
  std::map<std::string, std::string> properties_;
};

}  // namespace

bool EntityPolicy::IsOne(const std::string& path) {
  try {
    const onnx::ModelProto model = ReadModel(path);
    for (const auto& entry : model.metadata_props()) {
      if (entry.key() == "stg.observation_layout") return entry.value() == kEntityLayout;
    }
  } catch (const UserError&) {
    return false;
  }
  return false;
}

EntityPolicy EntityPolicy::LoadOnnx(const std::string& path) {
  const onnx::ModelProto model = ReadModel(path);
  try {
    return EntityPolicy(EntityReader(path, model).Read());
  } catch (const UserError& error) {
    const std::string what = error.what();
    if (what.compare(0, path.size(), path) == 0) throw;
    throw UserError(path + ": not a policy: " + what);
  }
}

void EntityPolicy::SaveOnnx(const std::string& path) const {
  WriteDurably(BytesOf(ModelOf(parameters_)), path, "the policy");
}

}  // namespace stg::agent
