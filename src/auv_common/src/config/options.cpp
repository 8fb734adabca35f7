#include "auv_common/config/options.hpp"

#include <set>
#include <sstream>

#include "auv_common/config/value.hpp"
#include "auv_common/config/yaml_tree.hpp"
#include "auv_common/error.hpp"
#include "auv_common/names.hpp"

namespace stg::config {

void ApplyPairs(const Table& table, const std::string& pairs, const std::string& whole) {
  const std::string where = "'" + whole + "': ";
  std::set<std::string> given;
  // A comma at the end makes getline return the text after the last comma, even if it is empty.
  std::istringstream items(pairs + ",");
  for (std::string item; std::getline(items, item, ',');) {
    if (item.empty()) throw UserError(where + "a constant is missing after a colon or comma");
    const std::size_t equals = item.find('=');
    const std::string key = item.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : item.substr(equals + 1);
    if (!given.insert(key).second) throw UserError(where + key + ": given twice");
    const Field* field = table.Find(key);
    if (field == nullptr) {
      std::vector<std::string> keys;
      for (const Field& known : table.fields()) keys.push_back(known.path);
      const std::string nearest = NearestName(key, keys);
      throw UserError(where + "no such constant: " + key +
                      (!nearest.empty() ? "; did you mean " + nearest + "?"
                       : keys.empty()   ? "; it has none"
                                        : "; it has " + JoinNames(keys)));
    }
    if (const auto message = ParseValue(*field, ParseYaml(value, where + key, false))) {
      throw UserError(where + key + ": " + *message);
    }
  }
  for (const std::string& key : given) {
    const Owner* owner = table.Find(key)->Unchosen();
    if (owner != nullptr) throw UserError(where + key + ": " + owner->WhyUnread("this text"));
  }
}

}  // namespace stg::config
