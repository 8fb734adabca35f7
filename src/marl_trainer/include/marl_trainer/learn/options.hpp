#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"

/// The options of a training are a config::Table: the common ones, then the algorithm's. The path
/// of a field is the option's name on the command line without the dashes. The command line, ROS
/// parameters, config.json, the comparison of runs and the check of ranges all read this one list.
namespace stg::learn {

/// Widths of hidden layers. Their largest number is the limit of a policy file.
inline config::WholeNumbersRef Widths(std::vector<int>* hidden) { return {hidden, 7}; }

/// Throws UserError that names the option, "--lr: ...", if a value is out of range.
void RequireRanges(const config::Table& options);

/// Adds every option to the object, by name.
void DumpOptions(const config::Table& options, nlohmann::ordered_json* json);
/// Sets every option from the object. Throws UserError that names an option that is missing, has
/// another type, or has a value that does not fit its type.
void ReadOptions(const config::Table& options, const nlohmann::ordered_json& json);

/// Throws UserError "--option: what" if `ok` is false.
void RequireOption(bool ok, const std::string& option, const std::string& what);

}  // namespace stg::learn
