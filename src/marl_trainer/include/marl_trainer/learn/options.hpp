#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "auv_common/config/field.hpp"

/// The options of a training are a config::Table: the common ones, then the algorithm's. The path
/// of a field is the option's name on the command line without the dashes. Command line, ROS
/// parameters, config.json, comparison and the check of ranges read this one list.
namespace stg::learn {

/// Widths of hidden layers, as many as a policy file may have.
inline config::WholeNumbersRef Widths(std::vector<int>* hidden) { return {hidden, 7}; }

/// Throws UserError that names the option, "--lr: ...", for a value out of range.
void RequireRanges(const config::Table& options);

/// Adds every option to the object, by name.
void DumpOptions(const config::Table& options, nlohmann::ordered_json* json);
/// Fills every option from the object; UserError that names one that is missing, of another
/// type, or that its type cannot hold.
void ReadOptions(const config::Table& options, const nlohmann::ordered_json& json);

/// Throws UserError "--option: what" unless ok.
void RequireOption(bool ok, const std::string& option, const std::string& what);

}  // namespace stg::learn
