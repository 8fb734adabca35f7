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

/// How a section of a configuration file is described: one field per key, beside the struct that
/// it fills. Loading, saving, validation and the reference in docs/scenarios.md all read these
/// descriptions, so they cannot disagree.
///
/// A section is a plain, default-initialised struct with a function
///   void Describe(Section* section, config::Table* table);
/// and a configuration composes sections; see config/loader.hpp.
namespace stg::config {

/// Closed; what is drawn from it is uniform.
struct Interval {
  double lo = 0.0, hi = 0.0;
};

/// Allowed values [lo, hi], or (lo, hi] when lo is excluded. Holds for every
/// component of an array and both ends of an interval.
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
inline constexpr Limits kNone{};  ///< of keys that are not numbers

/// A choice among names; an index is the position of one, as in an enumeration.
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

/// One of these names, kept as text: what a registry makes (auv_common/registry.hpp), for which the
/// names are those registered when the section is described.
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

/// Any text in one line. Only options have one: what a key of a scenario says is a name or a file.
struct TextRef {
  std::string* text = nullptr;
};

/// Any number of rows of as many numbers each, written as a sequence of sequences.
struct RowsRef {
  std::vector<std::vector<double>>* rows = nullptr;
  int columns = 0;
};

/// Any number of names out of a list, written as a sequence.
struct NamesRef {
  std::vector<std::string>* list = nullptr;
  std::vector<std::string> names;  ///< allowed ones
};

/// A name, or the path of a file: the extension, e.g. ".nc", tells them apart. The path consists of
/// characters that stand in YAML and in a shell as they are.
struct NameOrFileRef {
  std::string* text = nullptr;
  std::string extension;
};

struct Field;

/// Where a model differs from the truth: paths of keys, each with the model's value as text.
using Differences = std::map<std::string, std::string>;

/// The value that a model has for a key: that of the key itself unless `all` holds another one.
struct DifferenceRef {
  Differences* all = nullptr;
  std::shared_ptr<const Field> of;  ///< the key, with the value that is true
};

using ValueRef = std::variant<double*, int*, std::int64_t*, std::uint64_t*, bool*, std::string*,
                              EnumRef, NumbersRef, Interval*, WholeNumbersRef, NamesRef, RowsRef,
                              NameOrFileRef, TextRef, DifferenceRef>;

/// A function for each type of a value, for std::visit.
template <class... F>
struct Overload : F... {
  using F::operator()...;
};
template <class... F>
Overload(F...) -> Overload<F...>;

/// The thing, or the few things, that a key belongs to, of those that a configuration chooses
/// among. A key of a thing that was not chosen has no effect, and is refused.
struct Owner {
  std::string kind;                ///< "target motion"
  std::vector<std::string> names;  ///< "evasive"; of a key that several share, all of them
  std::string key;                 ///< which chooses: "target.motion"
  /// What the configuration chooses; reads the struct that the table was made for.
  std::function<std::vector<std::string>()> chosen;

  bool IsChosen() const;
};

/// One key of a file and the member of the struct that it fills.
struct Field {
  std::string path;     ///< dotted, e.g. "time.dt_s"
  ValueRef value;       ///< points into the struct that the table was made for
  Limits limits;        ///< of numbers; unused for other types
  std::string unit;     ///< unit and, where it matters, frame
  std::string meaning;  ///< one sentence
  /// The value, as text, of a key that a file need not state; saving leaves it out, too.
  std::optional<std::string> fallback = {};
  std::vector<std::shared_ptr<const Owner>> owners = {};  ///< all of which must be chosen
  std::function<bool()> also_read = {};                   ///< whatever was chosen

  /// The owner that was not chosen, so that the key has no effect; null: it has its effect.
  const Owner* Unchosen() const;
};

/// All keys of a configuration in file order; keys of one section are adjacent. The references
/// are valid as long as the described struct stays where it is.
class Table {
 public:
  /// Keys added from here on lie in this section; "" is the top level. While a thing is described,
  /// the path counts from the thing's own section.
  void Section(const std::string& path) { prefix_ = path.empty() ? root_ : root_ + path + "."; }
  void Add(const std::string& key, ValueRef value, Limits limits, std::string unit,
           std::string meaning);
  /// A key that a file need not state: of things that are registered, for which the files of others
  /// shall not change. The member must have the value `fallback` by default.
  void AddOptional(const std::string& key, ValueRef value, const std::string& fallback,
                   Limits limits, std::string unit, std::string meaning);
  /// Keys of a thing, in a section of their own, which a file need not state.
  /// @param now, defaults describe the options that the keys fill, and default ones
  void Thing(Owner owner, const std::string& section, const std::function<void(Table*)>& now,
             const std::function<void(Table*)>& defaults);
  /// The same of options that are members of a struct. @param describe (T*, Table*) adds them
  template <class T, class F>
  void Thing(Owner owner, const std::string& section, T* options, F describe) {
    T defaults;
    Thing(
        std::move(owner), section, [&](Table* t) { describe(options, t); },
        [&](Table* t) { describe(&defaults, t); });
  }
  /// Says that a key, or all keys of a section at every depth, belong to this owner as well.
  void Own(const std::string& section, const Owner& owner);
  /// A key of a thing that is read where this holds, too, whatever was chosen.
  void AlsoReadIf(const std::string& path, std::function<bool()> holds);
  /// Keys in a section of their own that say what a model holds for some keys instead of the truth.
  /// Each takes what the key takes, belongs to what the key belongs to, and need not be stated.
  /// @param keys keys, or sections at every depth; those that this table lacks are passed over
  void Differ(const std::string& section, const std::vector<std::string>& keys,
              Differences* differences);
  /// A key or a section that files of earlier versions may have, and the one that replaces it: the
  /// refusal names it.
  void Moved(const std::string& from, const std::string& to) { moved_.emplace_back(from, to); }

  const std::vector<Field>& fields() const { return fields_; }
  /// The field of a whole path, or null.
  const Field* Find(const std::string& path) const;
  /// What keys lie in, at every depth: of "a.b.c", "a" and "a.b".
  const std::set<std::string>& sections() const { return sections_; }
  const std::vector<std::pair<std::string, std::string>>& moved() const { return moved_; }
  /// The key that a key of Differ is about; of other keys the path itself.
  std::string TrueKey(const std::string& path) const;

 private:
  std::string root_, prefix_;
  std::vector<Field> fields_;
  std::unordered_map<std::string, std::size_t> index_;  ///< of a path's field
  std::set<std::string> sections_;
  std::vector<std::pair<std::string, std::string>> moved_;
  std::string differences_;  ///< the section of Differ with a point; empty: there is none
};

/// Why a configuration as a whole is refused: the key to blame first, then the keys that it
/// contradicts.
struct Violation {
  std::vector<std::string> keys;
  std::string message;
};

}  // namespace stg::config
