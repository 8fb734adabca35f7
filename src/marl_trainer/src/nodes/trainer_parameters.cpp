#include "trainer_parameters.hpp"

#include <algorithm>
#include <cmath>

#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "auv_common/nodes/parameters.hpp"

namespace stg::nodes {
namespace {

std::string ParameterOf(std::string option) {
  std::replace(option.begin(), option.end(), '-', '_');
  return option;
}

/// The value of a parameter as text of a command line.
std::string TextOf(const std::string& name, XmlRpc::XmlRpcValue value) {
  using Value = XmlRpc::XmlRpcValue;
  switch (value.getType()) {
    case Value::TypeString:
      return value;
    case Value::TypeBoolean:
      return static_cast<bool>(value) ? "true" : "false";
    case Value::TypeInt:
      return std::to_string(static_cast<int>(value));
    case Value::TypeDouble: {
      const double number = value;
      // A whole number that is too large for the server's 32 bits is stored as a real one.
      const bool whole = std::floor(number) == number && std::abs(number) < 1e15;
      return whole ? std::to_string(static_cast<std::int64_t>(number))
                   : config::FormatNumber(number);
    }
    case Value::TypeArray: {
      std::string list;
      for (int i = 0; i < value.size(); ++i) list += (i > 0 ? ", " : "") + TextOf(name, value[i]);
      return "[" + list + "]";
    }
    default:
      throw UserError("parameter " + name + ": must be a number, true or false, text or a list");
  }
}

}  // namespace

std::vector<std::string> LoadTrainParameters(const config::Table& options,
                                             const std::vector<std::string>& except) {
  std::vector<std::string> given;
  for (const config::Field& option : options.fields()) {
    const std::string name = ParameterOf(option.path);
    // Only private parameters, because `seed`, for example, also exists for the world.
    XmlRpc::XmlRpcValue value;
    const bool skipped = std::find(except.begin(), except.end(), option.path) != except.end();
    if (skipped || !PrivateParameter(name, &value)) continue;
    if (const auto message = config::ParseText(option, TextOf(name, value))) {
      throw UserError("parameter " + name + ": " + *message);
    }
    given.push_back(option.path);
  }
  for (const std::string& path : given) {
    const config::Owner* owner = options.Find(path)->Unchosen();
    if (owner == nullptr) continue;
    throw UserError("parameter " + ParameterOf(path) + ": " + owner->WhyUnread("this node"));
  }
  return given;
}

void RefuseTrainParameters(const std::vector<std::string>& options, const std::string& why) {
  for (const std::string& option : options) RefuseParameter(ParameterOf(option), why);
}

std::vector<std::string> LoadBagNames() { return TextsParameter("bags"); }

}  // namespace stg::nodes
