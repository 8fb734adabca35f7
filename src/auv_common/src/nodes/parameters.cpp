#include "auv_common/nodes/parameters.hpp"

#include <ros/console.h>
#include <ros/master.h>
#include <ros/param.h>
#include <ros/this_node.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>
#include <vector>

#include "auv_common/config/files.hpp"
#include "auv_common/config/run_config.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"

namespace stg::nodes {
namespace {

/// Keys of a scenario's file that a graph may replace.
struct FileKeys {
  RunConfig run;
  std::string mode = "acoustic";
};

void Describe(FileKeys* k, config::Table* t) {
  Describe(&k->run, t);
  t->Section("");
  t->Add("mode", config::Name(&k->mode, {"truth", "acoustic"}), config::kNone, "-", "");
}

std::optional<config::Violation> FindConflict(const FileKeys& k) { return FindConflict(k.run); }

/// The private parameters that this node has asked for.
std::set<std::string>& Asked() {
  // PollLoop and the diagnostics read these two after the start.
  static std::set<std::string> names{"realtime_priority", "diagnostic_period"};
  return names;
}

/// Reads a parameter. Returns false if it is not set.
bool Find(const std::string& name, Reach reach, XmlRpc::XmlRpcValue* value) {
  if (PrivateParameter(name, value)) return true;
  return reach == Reach::kRun && ros::param::get("/" + name, *value);
}

[[noreturn]] void Refuse(const std::string& name, const std::string& wanted) {
  throw UserError("parameter " + name + ": must be " + wanted);
}

std::vector<std::string> Words(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

}  // namespace

bool PrivateParameter(const std::string& name, XmlRpc::XmlRpcValue* value) {
  Asked().insert(name);
  return ros::NodeHandle("~").getParam(name, *value);
}

void RequireAllParametersRead() {
  std::vector<std::string> all;
  if (!ros::param::getParamNames(all)) return;
  const std::string space = ros::this_node::getName() + "/";
  for (const std::string& path : all) {
    if (path.compare(0, space.size(), space) != 0) continue;
    const std::string name = path.substr(space.size());
    // The server lists the entries of a map one by one, as NAME/KEY.
    bool asked = false;
    for (std::size_t end = name.find('/'); !asked; end = name.find('/', end + 1)) {
      asked = Asked().count(name.substr(0, end)) > 0;
      if (end == std::string::npos) break;
    }
    if (asked) continue;
    const std::vector<std::string> known(Asked().begin(), Asked().end());
    const std::string near = NearestName(name, known);
    throw UserError("parameter " + name + ": this node does not read it" +
                    (near.empty() ? "" : ", did you mean " + near + "?") + " ('rosparam delete " +
                    path + "' removes it from the ROS master)");
  }
}

void RefuseParameter(const std::string& name, const std::string& why) {
  XmlRpc::XmlRpcValue ignored;
  if (PrivateParameter(name, &ignored)) throw UserError("parameter " + name + ": " + why);
}

std::vector<std::string> TextsParameter(const std::string& name, Reach reach) {
  XmlRpc::XmlRpcValue value;
  if (!Find(name, reach, &value)) return {};
  if (value.getType() == XmlRpc::XmlRpcValue::TypeString) return Words(value);
  if (value.getType() != XmlRpc::XmlRpcValue::TypeArray) Refuse(name, "a list of strings");
  std::vector<std::string> list;
  for (int i = 0; i < value.size(); ++i) {
    if (value[i].getType() != XmlRpc::XmlRpcValue::TypeString) Refuse(name, "a list of strings");
    list.push_back(value[i]);
  }
  return list;
}

std::string TextParameter(const std::string& name, const std::string& fallback, Reach reach) {
  XmlRpc::XmlRpcValue value;
  if (!Find(name, reach, &value)) return fallback;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeString) Refuse(name, "a text");
  return value;
}

bool FlagParameter(const std::string& name, bool fallback) {
  XmlRpc::XmlRpcValue value;
  if (!Find(name, Reach::kNode, &value)) return fallback;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeBoolean) Refuse(name, "true or false");
  return value;
}

double NumberParameter(const std::string& name, double fallback, double lo, double hi,
                       Reach reach) {
  XmlRpc::XmlRpcValue value;
  if (!Find(name, reach, &value)) return fallback;
  double number = 0.0;
  if (value.getType() == XmlRpc::XmlRpcValue::TypeInt) {
    number = static_cast<int>(value);
  } else if (value.getType() == XmlRpc::XmlRpcValue::TypeDouble) {
    number = value;
  } else {
    Refuse(name, "a number");
  }
  if (!std::isfinite(number) || number < lo || number > hi) {
    Refuse(name, "from " + std::to_string(lo) + " to " + std::to_string(hi));
  }
  return number;
}

int IntegerParameter(const std::string& name, int fallback, int lo, int hi, Reach reach) {
  const double number = NumberParameter(name, fallback, lo, hi, reach);
  if (number != std::floor(number)) Refuse(name, "a whole number");
  return static_cast<int>(number);
}

void RequireIndices(const std::string& name, int count) {
  XmlRpc::XmlRpcValue value;
  if (!Find(name, Reach::kNode, &value)) return;
  XmlRpc::XmlRpcValue list = value;
  if (value.getType() != XmlRpc::XmlRpcValue::TypeArray) {
    list = XmlRpc::XmlRpcValue();
    list[0] = value;
  }
  std::set<int> seen;
  for (int i = 0; i < list.size(); ++i) {
    const bool is_number = list[i].getType() == XmlRpc::XmlRpcValue::TypeInt;
    const int index = is_number ? static_cast<int>(list[i]) : -1;
    if (index < 0 || index >= count || !seen.insert(index).second) {
      Refuse(name, "a list of different numbers from 0 to " + std::to_string(count - 1) +
                       ", the indices of the AUVs");
    }
  }
}

bool SimulatedTimeParameter() {
  XmlRpc::XmlRpcValue request, response, value;
  request[0] = ros::this_node::getName();
  request[1] = std::string("/use_sim_time");
  // This call fails if the parameter is not set.
  return ros::master::execute("getParam", request, response, value, true) &&
         value.getType() == XmlRpc::XmlRpcValue::TypeBoolean && static_cast<bool>(value);
}

config::Source ScenarioSource() {
  std::vector<std::string> overrides = TextsParameter("overrides", Reach::kRun);
  const auto given = [&overrides](const std::string& start) {
    return std::find_if(overrides.begin(), overrides.end(),
                        [&start](const std::string& text) { return text.rfind(start, 0) == 0; });
  };
  // If the overrides state a number, RequireAgents compares the two.
  const int agents = IntegerParameter("agents", 0, 0, 255, Reach::kRun);
  if (agents > 0 && given("agents=") == overrides.end()) {
    overrides.push_back("agents=" + std::to_string(agents));
  }
  const std::string mode = "mode=acoustic";
  if (const auto other = given("mode="); other == overrides.end()) {
    overrides.push_back(mode);
  } else if (*other != mode) {
    throw UserError("parameter overrides: " + config::Quoted(*other) +
                    ": nodes know only what they measure and receive, so a run of nodes always has "
                    "mode=acoustic; 'evaluate' flies with mode=truth");
  }
  for (const std::string& library : TextsParameter("plugins", Reach::kRun)) {
    overrides.push_back("plugins=[\"" + library + "\"]");
  }
  return config::NamedSource(config::ScenarioFolder(),
                             TextParameter("scenario", "medium", Reach::kRun),
                             TextParameter("condition", "nominal", Reach::kRun), overrides);
}

void RequireAgents(int agents) {
  const int wanted = IntegerParameter("agents", 0, 0, 255, Reach::kRun);
  if (wanted > 0 && agents != wanted) {
    throw UserError("parameter overrides: the number of AUVs is the launch argument 'agents'");
  }
}

void WarnOfReplacedKeys(int agents) {
  const std::string name = TextParameter("scenario", "medium", Reach::kRun);
  const config::Source file = config::NamedSource(config::ScenarioFolder(), name);
  const FileKeys own = config::Load<FileKeys>(file, config::Scope::kOwnSections);
  if (own.run.agents != agents) {
    ROS_WARN("%d AUVs, from the launch argument 'agents'; scenario '%s' itself has %d", agents,
             name.c_str(), own.run.agents);
  }
  if (own.mode != "acoustic") {
    ROS_WARN(
        "scenario '%s' has mode: %s, but nodes know only what they measure and receive: this "
        "run has mode: acoustic",
        name.c_str(), own.mode.c_str());
  }
}

}  // namespace stg::nodes
