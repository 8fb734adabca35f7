#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "auv_dynamics/scenario.hpp"

/// One description per scenario key. Loading, saving, validation and the
/// reference in docs/scenarios.md all read this table, so they cannot disagree.
namespace stg {

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

/// An enumeration by its names; an index is the enumerator's value.
struct EnumRef {
  std::vector<std::string> names;
  std::function<int()> get;
  std::function<void(int)> set;
};

/// A fixed number of doubles, written as a sequence.
struct NumbersRef {
  double* data = nullptr;
  int size = 0;
};

using ValueRef = std::variant<double*, int*, std::uint64_t*, bool*, std::string*, EnumRef,
                              NumbersRef, Interval*>;

/// One key of a scenario file and the member of the struct that it fills.
struct ScenarioField {
  std::string path;     ///< dotted, e.g. "time.dt_s"
  ValueRef value;       ///< points into the scenario the table was made for
  Limits limits;        ///< of numbers; unused for other types
  std::string unit;     ///< unit and, where it matters, frame
  std::string meaning;  ///< one sentence
};

/// All keys in file order; keys of one section are adjacent. The references are
/// valid as long as *scenario stays where it is.
std::vector<ScenarioField> ScenarioFields(Scenario* scenario);

/// Why a scenario as a whole is refused: the key to blame first, then the keys
/// that it contradicts.
struct Violation {
  std::vector<std::string> keys;
  std::string message;
};

/// First violation of a range or of a rule between keys, else nothing.
std::optional<Violation> FindViolation(const Scenario& scenario);

}  // namespace stg
