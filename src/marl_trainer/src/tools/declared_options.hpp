#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <variant>

#include "auv_common/config/field.hpp"
#include "auv_common/config/value.hpp"

namespace stg::learn {

/// Declares an option for each field of the table, "--path VALUE"; a flag's value may be left out.
/// The table must live until the command line is parsed.
inline void DeclareOptions(const config::Table& table, CLI::App* app) {
  for (const config::Field& option : table.fields()) {
    const auto take = [&option](const std::string& text) {
      const auto message = config::ParseText(option, text);
      if (message) throw CLI::ValidationError("--" + option.path, *message);
    };
    const std::string range = config::FormatRange(option);
    const std::string value = config::FormatValue(option.value);
    CLI::Option* declared =
        app->add_option_function<std::string>("--" + option.path, take, option.meaning);
    if (std::holds_alternative<bool*>(option.value)) {
      // What CLI11 takes for a value that is left out is this text, which help does not show.
      declared->expected(0, 1)->default_str("true")->option_text(range + "=" + value);
    } else {
      declared->type_name(range)->default_str(value);
    }
  }
}

}  // namespace stg::learn
