#include "stg_agent/controllers/controller.hpp"

#include "auv_common/error.hpp"
#include "auv_common/names.hpp"

namespace stg::agent {

void Controller::Act(const AgentView& agent, float* action) const {
  const NearestSights nearest = agent.Nearest();
  double a[dynamics::kMaxActionSize] = {};
  Act(InputOf(agent, nearest), a);
  for (int k = 0; k < agent.model().control.action_size(); ++k)
    action[k] = static_cast<float>(a[k]);
}

std::shared_ptr<const Controller> MakeController(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string name = text.substr(0, colon);
  if (!Controllers().Has(name)) return nullptr;
  config::OptionsByName options;
  config::Table table;
  Controllers().DescribeOne(name, &options, &table);
  if (colon != std::string::npos) config::ApplyPairs(table, text.substr(colon + 1), text);
  return Controllers().Make(name, options);
}

void RequirePolicyFileName(const std::string& text) {
  const std::string ending = ".onnx";
  if (text.size() > ending.size() &&
      text.compare(text.size() - ending.size(), ending.size(), ending) == 0) {
    return;
  }
  std::vector<std::string> names = Controllers().Names();
  const std::string nearest = NearestName(text.substr(0, text.find(':')), names);
  throw UserError("policy '" + text + "': neither an .onnx file nor one of " + JoinNames(names) +
                  (nearest.empty() ? "" : "; did you mean " + nearest + "?"));
}

}  // namespace stg::agent
