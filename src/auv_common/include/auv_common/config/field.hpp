#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>

/// Description of a section of a configuration file: one field per key, beside the struct that the
/// section fills. Loading, saving, validation and the reference in docs/scenarios.md all read these
/// descriptions, so they cannot disagree.
///
/// A section is a plain, default-initialised struct with a function
///   void Describe(Section* section, config::Table* table);
/// A configuration composes sections; see config/loader.hpp.
namespace stg::config {

/// Closed interval. Draws from it are uniform.
struct Interval {
  double lo = 0.0, hi = 0.0;
};

/// Allowed values [lo, hi], or (lo, hi] when lo is excluded. The limits apply to every component of
/// an array and to both ends of an interval.
struct Limits {
  double lo = 0.0;
  double hi = 0.0;
  bool lo_excluded = false;

  bool Contain(double value) const {
    return (lo_excluded ? value > lo : value >= lo) && value <= hi;
  }
};

inline Limits Positive(double hi) { return {0.0, hi, true}; }
inline Limits NonNegative(double hi) { return {0.0, hi, false}; }
inline Limits Within(double lo, double hi) { return {lo, hi, false}; }
inline constexpr Limits kFraction{0.0, 1.0, false};
inline constexpr Limits kNone{};  ///< for keys that are not numbers

/// A choice among names. The index is the position of the name, as in an enumeration.
struct EnumRef {
  std::vector<std::string> names;
  std::function<int()> get;  ///< -1: none of the names
  std::function<void(int)> set;
};

template <class E>
EnumRef Enum(E* value, std::vector<std::string> names) {
  return {std::move(names), [value] { return static_cast<int>(*value); },
          [value](int index) { *value = static_cast<E>(index); }};
}

/// One of these names, kept as text, such as the name of a thing in a registry
/// (auv_common/registry.hpp). There the names are those that are registered when the section is
/// described.
EnumRef Name(std::string* value, std::vector<std::string> names);

/// A fixed number of doubles, written as a sequence.
struct NumbersRef {
  double* data = nullptr;
  int size = 0;
};

template <std::size_t N>
NumbersRef Numbers(std::array<double, N>* values) {
  return {values->data(), static_cast<int>(N)};
}

/// One to `most` whole numbers, written as a sequence.
struct WholeNumbersRef {
  std::vector<int>* list = nullptr;
  int most = 1;
};

/// Any text in one line. Only options have such keys; a key of a scenario is a name or a file.
struct TextRef {
  std::string* text = nullptr;
};

/// Any number of rows, written as a sequence of sequences. All rows have the same number of
/// columns.
struct RowsRef {
  std::vector<std::vector<double>>* rows = nullptr;
  int columns = 0;
};

/// Any number of names from a list, written as a sequence.
struct NamesRef {
  std::vector<std::string>* list = nullptr;
  std::vector<std::string> names;  ///< the allowed names
};

/// A name, or the path of a file. The extension, e.g. ".nc", tells them apart. The path has only
/// characters that need no quotes in YAML or in a shell.
struct NameOrFileRef {
  std::string* text = nullptr;
  std::string extension;
};

struct Field;

/// Differences between a model and the truth: paths of keys, and the model's value of each as text.
using Differences = std::map<std::string, std::string>;

/// A model's value of a key: the value in `all`, or the key's own value if `all` has none.
struct DifferenceRef {
  Differences* all = nullptr;
  std::shared_ptr<const Field> of;  ///< the key, with the true value
};

using ValueRef = std::variant<double*, int*, std::int64_t*, std::uint64_t*, bool*, std::string*,
                              EnumRef, NumbersRef, Interval*, WholeNumbersRef, NamesRef, RowsRef,
                              NameOrFileRef, TextRef, DifferenceRef>;

/// One function for each type of value, for std::visit.
template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

/// The thing, or the few things, that a key belongs to. The configuration chooses among the things
/// of a kind. A key has no effect if its thing was not chosen, and is then refused.
struct Owner {
  std::string kind;                ///< e.g. "target motion"
  std::vector<std::string> names;  ///< e.g. "evasive"; more names if several things share the key
  std::string key;                 ///< the key that chooses, e.g. "target.motion"
  /// What the configuration chooses. Reads the struct of the table.
  std::function<std::vector<std::string>()> chosen;
  std::vector<std::string> other_keys = {};  ///< keys that choose together with `key`
  /// A file states the keys of all things of this kind, because a command may choose another one on
  /// top of it. Only an override that has no effect is refused.
  bool files_state_all = false;
  std::string refusal = {};  ///< replaces the sentence that names the owner and the choice

  bool IsChosen() const;
  /// For messages: "belongs to the KIND 'a' or 'b'; CHOOSER chose 'c' (KEYS)", or `refusal`.
  /// @param chooser e.g. "this configuration" @param prefix of the keys, e.g. "--"
  std::string WhyUnread(const std::string& chooser, const std::string& prefix = "") const;
};

/// One key of a file and the member of the struct that it fills.
struct Field {
  std::string path;     ///< dotted, e.g. "time.dt_s"
  ValueRef value;       ///< points into the struct of the table
  Limits limits;        ///< for numbers; unused for other types
  std::string unit;     ///< unit and, where it matters, frame
  std::string meaning;  ///< one sentence
  /// Value, as text, of a key that a file may omit. Saving omits the key at this value.
  std::optional<std::string> fallback = {};
  std::vector<std::shared_ptr<const Owner>> owners = {};  ///< all of them must be chosen
  std::function<bool()> also_read = {};  ///< true: the key is read whatever was chosen

  /// The owner that was not chosen, so that the key has no effect; null: the key has an effect.
  const Owner* Unchosen() const;
  /// True: a file may state the key, and saving writes it.
  bool InFiles() const;
};

/// All keys of a configuration, in file order. The keys of one section are adjacent. The references
/// are valid as long as the described struct stays in its place.
class Table {
 public:
  /// Sets the section of the keys that are added next; "" is the top level. While a thing is
  /// described, the path starts at the thing's own section.
  void Section(const std::string& path) { prefix_ = path.empty() ? root_ : root_ + path + "."; }
  void Add(const std::string& key, ValueRef value, Limits limits, std::string unit,
           std::string meaning);
  /// Adds a key that a file may omit. Registered things use it, so that a new key does not
  /// invalidate the files of other users. The member must have the value `fallback` by default.
  void AddOptional(const std::string& key, ValueRef value, const std::string& fallback,
                   Limits limits, std::string unit, std::string meaning);
  /// Adds the keys of a thing in a section of their own. A file may omit them.
  /// @param now describes the options that the keys fill @param defaults describes default options
  void Thing(Owner owner, const std::string& section, const std::function<void(Table*)>& now,
             const std::function<void(Table*)>& defaults);
  /// The same for options that are members of a struct. @param describe (T*, Table*) adds the keys
  template <class T, class F>
  void Thing(Owner owner, const std::string& section, T* options, F describe) {
    T defaults;
    Thing(
        std::move(owner), section, [&](Table* t) { describe(options, t); },
        [&](Table* t) { describe(&defaults, t); });
  }
  /// Makes a key, or all keys of a section at every depth, belong to this owner, too.
  void Own(const std::string& section, const Owner& owner);
  /// Lets a key of a thing also be read where `holds` is true, whatever was chosen.
  void AlsoReadIf(const std::string& path, std::function<bool()> holds);
  /// Adds keys in a section of their own: the values that a model has instead of the true ones.
  /// Each takes the same values and belongs to the same things as the true key. A file may omit it.
  /// @param keys keys, or sections at every depth; keys that are not in this table are ignored
  void Differ(const std::string& section, const std::vector<std::string>& keys,
              Differences* differences);
  /// Names a key or section of earlier versions, and the one that replaces it. The message that
  /// refuses the old one names the new one.
  void Moved(const std::string& from, const std::string& to) { moved_.emplace_back(from, to); }

  const std::vector<Field>& fields() const { return fields_; }
  /// The field of a full path, or null.
  const Field* Find(const std::string& path) const;
  /// All sections that contain keys, at every depth: "a" and "a.b" for the key "a.b.c".
  const std::set<std::string>& sections() const { return sections_; }
  const std::vector<std::pair<std::string, std::string>>& moved() const { return moved_; }
  /// The true key of a key of Differ; the path itself for all other keys.
  std::string TrueKey(const std::string& path) const;

 private:
  std::string root_, prefix_;
  std::vector<Field> fields_;
  std::unordered_map<std::string, std::size_t> index_;  ///< index of the field of each path
  std::set<std::string> sections_;
  std::vector<std::pair<std::string, std::string>> moved_;
  std::string differences_;  ///< section of Differ, with a point at the end; empty: none
};

/// The reason why a configuration as a whole is refused: first the key to change, then the keys
/// that it contradicts.
struct Violation {
  std::vector<std::string> keys;
  std::string message;
};

}  // namespace stg::config
