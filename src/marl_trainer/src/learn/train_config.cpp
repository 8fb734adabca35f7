#include "marl_trainer/learn/train_config.hpp"

#include <algorithm>
#include <utility>

#include "auv_common/error.hpp"
#include "auv_common/names.hpp"
#include "auv_common/numbers/lanes.hpp"
#include "marl_trainer/learn/checked_json.hpp"

namespace stg::learn {

void TrainConfig::Describe(config::Table* table) {
  table->Add("seed", &seed, config::kNone, "-", "seed of weights, exploration and episodes");
  table->Add("steps", &steps, {1, 1e12}, "-", "environment steps to train for");
  table->Add("envs", &envs, {1, 65536}, "-", "parallel environments");
  table->Add("horizon", &horizon, {1, 100000}, "-",
             "decisions of each environment between two updates");
  table->Add("stagger", &stagger, config::kNone, "-",
             "the first episodes end at different times, so that episodes do not all end together");
  table->Add("start-from", config::TextRef{&start_from}, config::kNone, "-",
             "folder of a finished run; the training starts with its networks and normalisers, but "
             "with new steps, optimiser and exploration; empty: untrained networks");
  table->Add("validation-interval", &validation_interval, {1, 1e12}, "-",
             "environment steps between validations");
  table->Add("validation-episodes", &validation_episodes, {1, 10000}, "-",
             "held-out episodes per validation");
  table->Add("checkpoint-interval", &checkpoint_interval, {1, 1e12}, "-",
             "environment steps between checkpoints");
  table->Add("keep-checkpoints", &keep_checkpoints, {1, 1000}, "-", "checkpoints kept");
}

TrainSetup::TrainSetup(const std::string& name, const std::string& preset)
    : algorithm(name), own(Algorithms().Make(name)) {
  common.preset = preset;
  own->ApplyPreset(preset, &common);
}

TrainSetup::TrainSetup(const TrainSetup& other)
    : algorithm(other.algorithm), common(other.common), own(other.own->Clone()) {}

TrainSetup& TrainSetup::operator=(const TrainSetup& other) { return *this = TrainSetup(other); }

config::Table TrainSetup::Options() {
  config::Table table;
  common.Describe(&table);
  own->Describe(&table);
  return table;
}

void TrainSetup::ValidateOrThrow() const {
  TrainSetup copy(*this);  // a table refers to values that it may change
  RequireRanges(copy.Options());
  own->ValidateOrThrow(common);
}

nlohmann::ordered_json ToJson(const TrainSetup& setup) {
  nlohmann::ordered_json json;
  json["algorithm"] = setup.algorithm;
  json["preset"] = setup.common.preset;
  json["variant"] = env::NameOf(setup.common.variant);
  TrainSetup copy(setup);
  DumpOptions(copy.Options(), &json);
  return json;
}

TrainSetup TrainSetupFromJson(const nlohmann::ordered_json& json) {
  try {
    std::string algorithm;
    TakeMember(json, "algorithm", &algorithm);
    TrainSetup setup(algorithm, "fast");  // all values of the preset are replaced
    TakeMember(json, "preset", &setup.common.preset);
    std::string variant;
    TakeMember(json, "variant", &variant);
    const std::vector<std::string>& names = env::VariantNames();
    const auto known = std::find(names.begin(), names.end(), variant);
    if (known == names.end()) throw UnknownName("variant", variant, names);
    setup.common.variant = static_cast<env::Variant>(known - names.begin());
    const config::Table table = setup.Options();
    ReadOptions(table, json);
    if (json.size() != 3 + table.fields().size()) throw UserError("unknown fields");
    return setup;
  } catch (const UserError& error) {
    throw UserError(std::string("training configuration: ") + error.what());
  }
}

}  // namespace stg::learn
