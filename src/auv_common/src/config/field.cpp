#include "auv_common/config/field.hpp"

#include <algorithm>

#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"
#include "key_path.hpp"

namespace stg::config {
namespace {

/// 'a' or 'b', with this word between names; "none" if there are no names.
std::string QuotedNames(const std::vector<std::string>& names, const std::string& word) {
  std::string text;
  for (const std::string& name : names) {
    text += (text.empty() ? "'" : " " + word + " '") + name + "'";
  }
  return text.empty() ? "none" : text;
}

}  // namespace

bool Owner::IsChosen() const {
  const std::vector<std::string> choice = chosen();
  return std::find_first_of(choice.begin(), choice.end(), names.begin(), names.end()) !=
         choice.end();
}

std::string Owner::WhyUnread(const std::string& chooser, const std::string& prefix) const {
  if (!refusal.empty()) return refusal;
  std::string keys = prefix + key;
  for (const std::string& other : other_keys) keys += ", " + prefix + other;
  return "belongs to the " + kind + " " + QuotedNames(names, "or") + "; " + chooser + " chose " +
         QuotedNames(chosen(), "and") + " (" + keys + ")";
}

const Owner* Field::Unchosen() const {
  const Owner* in_files = nullptr;
  for (const auto& owner : owners) {
    if (owner->IsChosen() || (also_read && also_read())) continue;
    if (!owner->files_state_all) return owner.get();
    in_files = owner.get();
  }
  return in_files;
}

bool Field::InFiles() const {
  const Owner* const owner = Unchosen();
  return owner == nullptr || owner->files_state_all;
}

void Table::Add(const std::string& key, ValueRef value, Limits limits, std::string unit,
                std::string meaning) {
  const std::string path = prefix_ + key;
  const std::string section = Parent(path);
  if (fields_.empty() || section != Parent(fields_.back().path)) {
    for (std::string p = section; !p.empty(); p = Parent(p)) sections_.insert(p);
  }
  index_[path] = fields_.size();
  fields_.push_back({path, std::move(value), limits, std::move(unit), std::move(meaning)});
}

void Table::AddOptional(const std::string& key, ValueRef value, const std::string& fallback,
                        Limits limits, std::string unit, std::string meaning) {
  Add(key, std::move(value), limits, std::move(unit), std::move(meaning));
  fields_.back().fallback = fallback;
}

void Table::Thing(Owner owner, const std::string& section, const std::function<void(Table*)>& now,
                  const std::function<void(Table*)>& defaults) {
  Table plain;
  defaults(&plain);
  const std::string root = root_, prefix = prefix_;
  Section(section);
  root_ = prefix_;
  const std::size_t first = fields_.size();
  now(this);
  const auto shared = std::make_shared<const Owner>(std::move(owner));
  for (std::size_t k = 0; k < plain.fields().size(); ++k) {
    Field& field = fields_[first + k];
    field.fallback = FormatValue(plain.fields()[k].value);
    field.owners.push_back(shared);
  }
  root_ = root;
  prefix_ = prefix;
}

void Table::Own(const std::string& section, const Owner& owner) {
  const auto shared = std::make_shared<const Owner>(owner);
  for (Field& field : fields_) {
    const bool inside = field.path == section || field.path.rfind(section + ".", 0) == 0;
    if (inside) field.owners.push_back(shared);
  }
}

void Table::AlsoReadIf(const std::string& path, std::function<bool()> holds) {
  fields_[index_.at(path)].also_read = std::move(holds);
}

void Table::Differ(const std::string& section, const std::vector<std::string>& keys,
                   Differences* differences) {
  differences_ = section + ".";
  const std::size_t count = fields_.size();
  for (const std::string& key : keys) {
    const std::string inside = key + ".";
    for (std::size_t k = 0; k < count; ++k) {
      const std::string& path = fields_[k].path;
      if (path != key && path.compare(0, inside.size(), inside) != 0) continue;
      const Field of = fields_[k];  // a copy, because adding a field moves the others
      Section(section + "." + Parent(of.path));
      AddOptional(Leaf(of.path), DifferenceRef{differences, std::make_shared<const Field>(of)}, "",
                  of.limits, of.unit, "the agents' value of " + of.path);
      fields_.back().owners = of.owners;
      fields_.back().also_read = of.also_read;
    }
  }
}

std::string Table::TrueKey(const std::string& path) const {
  const bool differs = !differences_.empty() && path.rfind(differences_, 0) == 0;
  return differs ? path.substr(differences_.size()) : path;
}

const Field* Table::Find(const std::string& path) const {
  const auto found = index_.find(path);
  return found == index_.end() ? nullptr : &fields_[found->second];
}

std::string TextOf(const DifferenceRef& difference) {
  const auto found = difference.all->find(difference.of->path);
  return found == difference.all->end() ? std::string() : found->second;
}

std::optional<std::string> ParseDifference(const DifferenceRef& difference, const YamlTree& node) {
  // The key itself parses the value. Its own value is restored below.
  const Field& key = *difference.of;
  const std::string truth = FormatValue(key.value);
  std::optional<std::string> message = ParseValue(key, node);
  if (!message) (*difference.all)[key.path] = FormatValue(key.value);
  ParseText(key, truth);
  return message;
}

std::optional<std::string> CheckDifference(const DifferenceRef& difference) {
  const std::string text = TextOf(difference);
  if (text.empty()) return {};
  return ParseDifference(difference, ParseYaml(text, difference.of->path, false));
}

void Apply(const Differences& differences, const Table& table) {
  for (const auto& [path, text] : differences) {
    const Field* const field = table.Find(path);
    if (field == nullptr) continue;
    if (const auto message = ParseText(*field, text)) throw UserError(path + ": " + *message);
  }
}

}  // namespace stg::config
