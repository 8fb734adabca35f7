#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace stg::learn {

/// Closed range of an option; of each number of a list.
struct Range {
  double lo = 0.0, hi = 0.0;
};

/// One option of a training and the member of the struct that it fills.
struct Option {
  using Value = std::variant<double*, int*, std::int64_t*, std::uint64_t*, bool*, std::string*,
                             std::vector<int>*>;
  std::string name;  ///< as on the command line, without the dashes
  Value value;       ///< points into the struct that the table was made for
  Range range;       ///< of numbers; unused for flags and texts
  std::string meaning;
  std::vector<std::string> choices;  ///< of a text; empty: any
};

/// All options of a training: the common ones, then the algorithm's. Command line, ROS parameters,
/// dump, comparison and the check of ranges read this one list. Its references are valid as long
/// as the described structs stay where they are.
class OptionTable {
 public:
  template <class T>
  void Add(std::string name, T* value, Range range, std::string meaning) {
    options_.push_back({std::move(name), value, range, std::move(meaning), {}});
  }
  void Add(std::string name, bool* value, std::string meaning) {
    Add(std::move(name), value, Range(), std::move(meaning));
  }
  void Add(std::string name, std::string* value, std::string meaning) {
    Add(std::move(name), value, Range(), std::move(meaning));
  }
  /// One of several texts, which the meaning explains.
  void Add(std::string name, std::string* value, std::vector<std::string> choices,
           std::string meaning) {
    options_.push_back({std::move(name), value, Range(), std::move(meaning), std::move(choices)});
  }
  /// Any 64-bit seed.
  void Add(std::string name, std::uint64_t* value, std::string meaning) {
    Add(std::move(name), value, Range(), std::move(meaning));
  }

  const std::vector<Option>& options() const { return options_; }

  /// Adds what options must be to each other; `check` throws UserError as RequireOption does.
  void Check(std::function<void()> check) { checks_.push_back(std::move(check)); }

  /// Throws UserError that names the option, "--lr: ...", for a value out of range, a text that is
  /// no choice, and what Check forbids.
  void RequireRanges() const;

  /// Adds every option to the object, by name.
  void Dump(nlohmann::ordered_json* json) const;
  /// Fills every option from the object; UserError that names one that is missing, of another
  /// type, or that its type cannot hold.
  void Read(const nlohmann::ordered_json& json) const;

 private:
  std::vector<Option> options_;
  std::vector<std::function<void()>> checks_;
};

/// Throws UserError "--option: what" unless ok.
void RequireOption(bool ok, const std::string& option, const std::string& what);

}  // namespace stg::learn
