#include "trainer_parameters.hpp"

#include <ros/node_handle.h>

#include <algorithm>
#include <sstream>
#include <type_traits>

#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {
namespace {

void Load(const std::string& name, std::string* value) { *value = TextParameter(name, *value); }
void Load(const std::string& name, bool* value) { *value = FlagParameter(name, *value); }
void Load(const std::string& name, double* value) {
  *value = NumberParameter(name, *value, -1e12, 1e12);
}
void Load(const std::string& name, std::vector<int>* value) {
  std::vector<int> list;
  const ros::NodeHandle node("~");
  if (!node.hasParam(name)) return;
  if (!node.getParam(name, list)) throw UserError("parameter " + name + ": must be whole numbers");
  *value = list;
}
template <class Integer>
std::enable_if_t<std::is_integral_v<Integer>> Load(const std::string& name, Integer* value) {
  const auto limit = static_cast<Integer>(2000000000);
  *value = static_cast<Integer>(
      IntegerParameter(name, static_cast<int>(std::min(*value, limit)), 0, 2000000000));
}

}  // namespace

void LoadTrainParameters(learn::TrainSetup* setup) {
  const ros::NodeHandle node("~");
  const learn::OptionTable table = setup->Options();
  for (const learn::Option& option : table.options()) {
    std::string name = option.name;
    std::replace(name.begin(), name.end(), '-', '_');
    // Private ones only: `seed` of the world, say, is another one.
    if (!node.hasParam(name)) continue;
    std::visit([&name](auto* field) { Load(name, field); }, option.value);
  }
}

std::vector<std::string> LoadBagNames() {
  const ros::NodeHandle node("~");
  std::vector<std::string> names;
  if (!node.hasParam("bags") || node.getParam("bags", names)) return names;
  std::istringstream in(TextParameter("bags", ""));
  for (std::string name; in >> name;) names.push_back(name);
  return names;
}

}  // namespace stg::nodes
