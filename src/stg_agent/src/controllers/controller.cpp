#include "stg_agent/controllers/controller.hpp"

#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "auv_common/error.hpp"
#include "auv_common/names.hpp"

namespace stg::agent {

void Controller::Act(const AgentView& agent, float* action) const {
  NeighbourSight<double> nearest[kNearestKnown];
  const int count = agent.Nearest(kNearestKnown, nearest);
  double a[dynamics::kMaxActionSize] = {};
  Act({agent.model(), agent.id(), agent.knowledge(), nearest, count}, a);
  for (int k = 0; k < agent.model().control.action_size(); ++k)
    action[k] = static_cast<float>(a[k]);
}

ControllerConstants::ControllerConstants(const std::string& text) : text_(text) {
  const std::size_t colon = text.find(':');
  std::istringstream rest(colon == std::string::npos ? "" : text.substr(colon + 1));
  for (std::string item; std::getline(rest, item, ',');) {
    const std::size_t equals = item.find('=');
    items_.push_back({item.substr(0, equals),
                      equals == std::string::npos ? "" : item.substr(equals + 1), false});
  }
}

void ControllerConstants::Read(const std::string& name, double largest, double* value) {
  known_.push_back(name);
  for (Item& item : items_) {
    if (item.name != name) continue;
    item.read = true;
    char* end = nullptr;
    *value = std::strtod(item.value.c_str(), &end);
    if (item.value.empty() || *end != '\0' || !(*value >= 0.0 && *value <= largest)) {
      std::ostringstream range;
      range << "'" << text_ << "': " << name << " must be a number from 0 to " << largest;
      throw UserError(range.str());
    }
  }
}

void ControllerConstants::RequireAllRead() const {
  for (const Item& item : items_) {
    if (item.read) continue;
    std::string text = "'" + text_ + "': no such constant: " + item.name;
    const std::string nearest = NearestName(item.name, known_);
    if (!nearest.empty()) text += "; did you mean " + nearest + "?";
    throw UserError(text);
  }
}

std::shared_ptr<const Controller> MakeController(const std::string& text) {
  const std::string name = text.substr(0, text.find(':'));
  if (!Controllers().Has(name)) return nullptr;
  ControllerConstants constants(text);
  std::shared_ptr<const Controller> controller = Controllers().Make(name, constants);
  constants.RequireAllRead();
  return controller;
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
