#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <variant>

#include "auv_common/config/field.hpp"
#include "auv_common/config/value.hpp"

namespace stg::learn {

/// Declares an option "--path VALUE" for each field of the table. The value of a flag may be
/// omitted. The table must exist until the command line is parsed.
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
      // CLI11 uses this text as the value if none is given; the help does not show it.
      declared->expected(0, 1)->default_str("true")->option_text(range + "=" + value);
    } else {
      declared->type_name(range)->default_str(value);
    }
  }
}

}  // namespace stg::learn
