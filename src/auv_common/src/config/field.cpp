#include "auv_common/config/field.hpp"

#include "key_path.hpp"

namespace stg::config {

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

const Field* Table::Find(const std::string& path) const {
  const auto found = index_.find(path);
  return found == index_.end() ? nullptr : &fields_[found->second];
}

}  // namespace stg::config
