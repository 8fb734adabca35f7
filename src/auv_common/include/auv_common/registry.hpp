#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "auv_common/names.hpp"

/// Things of one kind that a scenario chooses by name: vehicles, propagation models, algorithms ...
///
/// The suite's own things stand in one list, in the function that owns the registry:
///
///   MotionRegistry& TargetMotions() {
///     static MotionRegistry registry("target motion", {
///         {"constant_velocity", MakeConstantVelocity},
///         {"evasive", MakeEvasive},
///     });
///     return registry;
///   }
///
/// A thing is added by its own file and one line there. A program with things of its own adds them
/// at its start, `TargetMotions().Add("spiral", MakeSpiral)`, before it loads a scenario: the
/// key's range (config::Name) lists the names that are registered when the file is read. The
/// function-local object exists from its first use on, so this may happen in static initialisers
/// too. Add while another thread uses the registry is a race; Make and Names may run concurrently.
namespace stg {

template <class Interface, class... Args>
class Registry {
 public:
  using Factory = std::function<std::unique_ptr<Interface>(Args...)>;
  struct Entry {
    std::string name;
    Factory make;
  };

  /// @param kind what is registered, for messages: "target motion".
  Registry(std::string kind, std::vector<Entry> entries) : kind_(std::move(kind)) {
    for (Entry& entry : entries) Add(std::move(entry.name), std::move(entry.make));
  }
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Throws std::logic_error for a name that is taken or cannot stand in a file (see IsName), and
  /// for an empty factory: bugs of the program, not of its input.
  void Add(std::string name, Factory make) {
    if (!IsName(name)) throw std::logic_error(kind_ + ": '" + name + "' is no name");
    if (Has(name)) throw std::logic_error(kind_ + ": '" + name + "' is registered twice");
    if (!make) throw std::logic_error(kind_ + ": '" + name + "' has no factory");
    entries_.push_back({std::move(name), std::move(make)});
  }

  /// What the factory of this name makes of the arguments; never null. Throws UserError that lists
  /// the names for an unknown one, and whatever the factory throws.
  std::unique_ptr<Interface> Make(const std::string& name, Args... args) const {
    const Entry* entry = Find(name);
    if (entry == nullptr) throw UnknownName(kind_, name, Names());
    auto made = entry->make(std::forward<Args>(args)...);
    if (made == nullptr) throw std::logic_error(kind_ + ": '" + name + "' made nothing");
    return made;
  }

  bool Has(const std::string& name) const { return Find(name) != nullptr; }

  /// In the order in which they were added.
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) names.push_back(entry.name);
    return names;
  }

 private:
  const Entry* Find(const std::string& name) const {
    for (const Entry& entry : entries_) {
      if (entry.name == name) return &entry;
    }
    return nullptr;
  }

  std::string kind_;
  std::vector<Entry> entries_;
};

}  // namespace stg
