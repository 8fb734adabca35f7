#pragma once

#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "auv_common/config/options.hpp"
#include "auv_common/names.hpp"

/// Things of one kind that a scenario chooses by name: vehicles, propagation models, algorithms,
/// ...
///
/// The suite's own things are in one list, in the function that owns the registry:
///
///   MotionRegistry& TargetMotions() {
///     static MotionRegistry registry("target motion", {
///         STG_ENTRY(MotionRegistry, ConstantVelocityEntry),
///         STG_ENTRY(MotionRegistry, EvasiveEntry),
///     });
///     return registry;
///   }
///
/// A new thing needs one file of its own and one line in this list. The file ends with the entry.
/// No header declares it:
///
///   MotionRegistry::Entry EvasiveEntry() { return {"evasive", MakeEvasive}; }
///
/// The factory takes the arguments that all things of its kind take. If the thing has options of
/// its own, the factory takes them first: a struct with Describe (auv_common/config/options.hpp).
///
///   std::unique_ptr<TargetMotion> MakeEvasive(const EvasiveOptions&, const MotionSetup&);
///
/// A program with things of its own adds them at its start, `TargetMotions().Add("spiral",
/// MakeSpiral)`, before it loads a scenario. When the file is read, the range of the key
/// (config::Name) lists the registered names, and Describe adds the keys of the registered things.
/// The function-local object exists from its first use on, so static initialisers may add things,
/// too. Add is a race if another thread uses the registry at the same time. Make and Names may run
/// concurrently.
namespace stg {

template <class Interface, class... Args>
class Registry {
 public:
  using Pointer = std::unique_ptr<Interface>;
  using Factory = std::function<Pointer(Args...)>;

  /// A name, its factory, and the defaults of its options.
  struct Entry {
    Entry(std::string name, Factory make) : name(std::move(name)) {
      if (!make) return;
      this->make = [make = std::move(make)](const config::Options&, Args... args) {
        return make(std::forward<Args>(args)...);
      };
    }
    template <class Make, class = std::enable_if_t<std::is_invocable_r_v<Pointer, Make, Args...>>>
    Entry(std::string name, Make make) : Entry(std::move(name), Factory(std::move(make))) {}
    template <class Options, class Made>
    Entry(std::string name, Made (*make)(const Options&, Args...), Options defaults = {})
        : name(std::move(name)),
          defaults(config::Options::Of(std::move(defaults))),
          make([make](const config::Options& options, Args... args) -> Pointer {
            return make(*options.As<Options>(), std::forward<Args>(args)...);
          }) {}

    std::string name;
    config::Options defaults;
    std::function<Pointer(const config::Options&, Args...)> make;
  };

  /// @param kind what is registered, for messages, e.g. "target motion"
  Registry(std::string kind, std::vector<Entry> entries) : kind_(std::move(kind)) {
    for (Entry& entry : entries) Add(std::move(entry));
    own_ = entries_.size();
  }
  Registry(const Registry&) = delete;
  Registry& operator=(const Registry&) = delete;

  /// Throws std::logic_error for a name that is taken or that cannot stand in a file (see IsName),
  /// and for an empty factory. These are bugs of the program, not of its input.
  void Add(Entry entry) {
    if (!IsName(entry.name))
      throw std::logic_error(kind_ + ": '" + entry.name + "' is not a valid name");
    if (Has(entry.name)) {
      throw std::logic_error(kind_ + ": '" + entry.name + "' is registered twice");
    }
    if (!entry.make) throw std::logic_error(kind_ + ": '" + entry.name + "' has no factory");
    entries_.push_back(std::move(entry));
  }
  template <class Make>
  void Add(std::string name, Make make) {
    Add(Entry(std::move(name), std::move(make)));
  }

  /// The thing that the factory of this name makes of its options and the arguments; never null.
  /// Throws UserError that lists the names if the name is unknown. Exceptions of the factory pass
  /// through.
  Pointer Make(const std::string& name, const config::OptionsByName& options, Args... args) const {
    const Entry& entry = Need(name);
    const config::Options* own = options.Find(name);
    auto made = entry.make(own == nullptr ? entry.defaults : *own, std::forward<Args>(args)...);
    if (made == nullptr)
      throw std::logic_error(kind_ + ": '" + name + "': its factory returned nothing");
    return made;
  }
  /// The same with default options.
  Pointer Make(const std::string& name, Args... args) const {
    return Make(name, config::OptionsByName(), std::forward<Args>(args)...);
  }

  bool Has(const std::string& name) const { return Find(name) != nullptr; }
  /// True for a thing in the suite's own list; false for one that a program or plugin added.
  bool IsOwn(const std::string& name) const {
    const Entry* entry = Find(name);
    return entry != nullptr && entry < entries_.data() + own_;
  }

  /// Names in the order in which they were added.
  std::vector<std::string> Names() const {
    std::vector<std::string> names;
    for (const Entry& entry : entries_) names.push_back(entry.name);
    return names;
  }

  /// Adds the keys of every thing with options. The section of a thing is its name below `section`.
  /// @param chooser the key that chooses among the things @param chosen its value
  /// @param options filled by the keys; they must outlive the table
  void Describe(const std::string& section, const std::string& chooser,
                const std::function<std::vector<std::string>()>& chosen,
                config::OptionsByName* options, config::Table* table) const {
    for (const Entry& entry : entries_) {
      DescribeIn(section + "." + entry.name, entry.name, chooser, chosen, options, table);
    }
  }
  /// The same for one thing; `section` is the thing's own section.
  void DescribeIn(const std::string& section, const std::string& name, const std::string& chooser,
                  const std::function<std::vector<std::string>()>& chosen,
                  config::OptionsByName* options, config::Table* table) const {
    config::Options defaults = Need(name).defaults;
    if (defaults.empty()) return;
    table->Thing(
        {kind_, {name}, chooser, chosen}, section,
        [&](config::Table* t) { DescribeOne(name, options, t); },
        [&](config::Table* t) { defaults.DescribeTo(t); });
  }
  /// Adds the keys of one thing; nothing if it has no options. Throws UserError for an unknown
  /// name.
  void DescribeOne(const std::string& name, config::OptionsByName* options,
                   config::Table* table) const {
    const Entry& entry = Need(name);
    if (!entry.defaults.empty()) options->Need(name, entry.defaults)->DescribeTo(table);
  }

 private:
  const Entry* Find(const std::string& name) const {
    for (const Entry& entry : entries_) {
      if (entry.name == name) return &entry;
    }
    return nullptr;
  }
  const Entry& Need(const std::string& name) const {
    const Entry* entry = Find(name);
    if (entry == nullptr) throw UnknownName(kind_, name, Names());
    return *entry;
  }

  std::string kind_;
  std::vector<Entry> entries_;
  std::size_t own_ = 0;  ///< number of the first entries that are the suite's own
};

}  // namespace stg

/// The entry that a function without arguments returns. Another file defines the function, in the
/// namespace around this line.
#define STG_ENTRY(Registry, function)  \
  [] {                                 \
    extern Registry::Entry function(); \
    return function();                 \
  }()
