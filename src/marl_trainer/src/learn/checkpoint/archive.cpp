#include "marl_trainer/learn/checkpoint/archive.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <type_traits>
#include <utility>

#include "auv_common/error.hpp"

namespace stg::learn {

void Archive::Put(const std::string& name, Array array) {
  assert(!name.empty() && name.size() <= kMaxName);
  const bool added = arrays_.emplace(name, std::move(array)).second;
  assert(added);
  static_cast<void>(added);
}

void Archive::PutInteger(const std::string& name, std::int64_t value) {
  Put(name, std::vector<std::int64_t>{value});
}

void Archive::PutNumber(const std::string& name, double value) {
  Put(name, std::vector<double>{value});
}

void Archive::PutPart(const std::string& prefix, const Archive& part) {
  for (const auto& [name, array] : part.arrays_) Put(prefix + "." + name, array);
}

Archive Archive::Part(const std::string& prefix) const {
  Archive part;
  const std::string start = prefix + ".";
  for (auto it = arrays_.lower_bound(start);
       it != arrays_.end() && it->first.compare(0, start.size(), start) == 0; ++it) {
    part.Put(it->first.substr(start.size()), it->second);
  }
  return part;
}

bool Archive::operator==(const Archive& other) const {
  const auto same = [](const auto& a, const auto& b) {
    if (a.first != b.first || a.second.index() != b.second.index()) return false;
    return std::visit(
        [&b](const auto& x) {
          const auto& y = std::get<std::decay_t<decltype(x)>>(b.second);
          return x.size() == y.size() &&
                 (x.empty() || std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0);
        },
        a.second);
  };
  return std::equal(arrays_.begin(), arrays_.end(), other.arrays_.begin(), other.arrays_.end(),
                    same);
}

template <class T>
const T& Archive::Get(const std::string& name) const {
  const auto found = arrays_.find(name);
  if (found == arrays_.end()) throw UserError("'" + name + "' is missing");
  const T* array = std::get_if<T>(&found->second);
  if (array == nullptr) throw UserError("'" + name + "' has another type");
  return *array;
}

const std::vector<float>& Archive::Floats(const std::string& name) const {
  return Get<std::vector<float>>(name);
}
const std::vector<double>& Archive::Doubles(const std::string& name) const {
  return Get<std::vector<double>>(name);
}
const std::vector<std::int64_t>& Archive::Integers(const std::string& name) const {
  return Get<std::vector<std::int64_t>>(name);
}
const std::string& Archive::Text(const std::string& name) const { return Get<std::string>(name); }

std::int64_t Archive::Integer(const std::string& name) const {
  const std::vector<std::int64_t>& array = Integers(name);
  if (array.size() != 1) throw UserError("'" + name + "' is not one number");
  return array.front();
}

std::int64_t Archive::Count(const std::string& name) const {
  const std::int64_t count = Integer(name);
  if (count < 0 || count > kMaxCount) {
    throw UserError("'" + name + "' is " + std::to_string(count) + ", which is not a count");
  }
  return count;
}

double Archive::Number(const std::string& name) const { return Doubles(name, 1).front(); }

const std::vector<float>& Archive::Floats(const std::string& name, std::size_t size) const {
  const std::vector<float>& array = Floats(name);
  if (array.size() != size) throw UserError("'" + name + "' has another size");
  return array;
}

const std::vector<double>& Archive::Doubles(const std::string& name, std::size_t size) const {
  const std::vector<double>& array = Doubles(name);
  if (array.size() != size) throw UserError("'" + name + "' has another size");
  return array;
}

}  // namespace stg::learn
