#pragma once

#include <any>
#include <map>
#include <string>

#include "auv_common/config/field.hpp"

/// Options of things that are chosen by name. The options of a thing are a default-initialised,
/// copyable struct with a function
///   void Describe(MyOptions* options, config::Table* table);
/// in the thing's own file, which adds keys without a section. The registry
/// (auv_common/registry.hpp) finds the struct through the thing's factory.
namespace stg::config {

/// Options of one thing. Only the thing knows their type.
class Options {
 public:
  /// No options.
  Options() = default;
  template <class T>
  static Options Of(T value) {
    Options options;
    options.value_ = std::move(value);
    options.describe_ = [](std::any* any, Table* table) { Describe(std::any_cast<T>(any), table); };
    return options;
  }

  bool empty() const { return !value_.has_value(); }
  /// The options; null unless T is their type.
  template <class T>
  const T* As() const {
    return std::any_cast<T>(&value_);
  }
  /// Adds the keys of the options. The references last as long as this object.
  void DescribeTo(Table* table) {
    if (!empty()) describe_(&value_, table);
  }

 private:
  std::any value_;
  void (*describe_)(std::any*, Table*) = nullptr;
};

/// Options of the things of one kind, by name. A thing that is not in the map has its default
/// options.
class OptionsByName {
 public:
  /// The options of one thing; T's defaults if there are none, or none of this type.
  template <class T>
  T Get(const std::string& name) const {
    const Options* options = Find(name);
    const T* own = options == nullptr ? nullptr : options->As<T>();
    return own == nullptr ? T() : *own;
  }
  const Options* Find(const std::string& name) const {
    const auto found = by_name_.find(name);
    return found == by_name_.end() ? nullptr : &found->second;
  }
  /// The options of one thing; if there are none yet, a copy of `defaults` is added.
  Options* Need(const std::string& name, const Options& defaults) {
    return &by_name_.try_emplace(name, defaults).first->second;
  }

 private:
  std::map<std::string, Options> by_name_;
};

/// Fills the table from "key=value,key=value", the text after a thing's name in
/// "pursuit:gain=2,cap=0.5". Throws UserError that quotes `whole` and names the key, also for a key
/// that is given twice, for one that has no effect beside the others, and for a missing pair.
void ApplyPairs(const Table& table, const std::string& pairs, const std::string& whole);

}  // namespace stg::config
