#include "auv_common/command_line.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <type_traits>
#include <utility>

#include "auv_common/config/field.hpp"
#include "auv_common/config/plugins.hpp"
#include "auv_common/config/value.hpp"
#include "auv_common/error.hpp"

namespace stg {
namespace {

const char kPlugin[] = "--plugin";

std::string RefuseSign(const std::string& text) {
  return text.find('-') == std::string::npos ? "" : "a seed is a whole number from 0, not " + text;
}

int Report(const std::string& program, const std::exception& error, int status) {
  std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
  return status;
}

}  // namespace

CommandLine::Option& CommandLine::Option::Required() {
  option_->required();
  return *this;
}

CommandLine::Option& CommandLine::Option::ShowDefault() {
  option_->capture_default_str();
  return *this;
}

CommandLine::Option& CommandLine::Option::From(int lo, int hi) {
  option_->check(CLI::Range(lo, hi));
  return *this;
}

CommandLine::Option& CommandLine::Option::OneOf(const std::vector<std::string>& names) {
  option_->check(CLI::IsMember(names));
  return *this;
}

CommandLine::Option& CommandLine::Option::Values(int count) {
  option_->expected(count);
  return *this;
}

CommandLine::Option& CommandLine::Option::OneValuePerUse() {
  option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}

CommandLine::Option& CommandLine::Option::SplitAt(char comma) {
  option_->delimiter(comma);
  return *this;
}

CommandLine::Option& CommandLine::Option::Needs(const std::string& name) {
  option_->needs(app_->get_option(name));
  return *this;
}

CommandLine::Option& CommandLine::Option::Group(const std::string& title) {
  option_->group(title);
  return *this;
}

CommandLine::CommandLine(std::string program, const std::string& description)
    : program_(std::move(program)), app_(std::make_unique<CLI::App>(description)) {}

CommandLine::~CommandLine() = default;

CommandLine::Option CommandLine::Add(const std::string& name, Target target,
                                     const std::string& meaning) {
  return std::visit(
      [&](auto* value) {
        using Value = std::remove_pointer_t<decltype(value)>;
        if constexpr (std::is_same_v<Value, bool>) {
          return Option(app_.get(), app_->add_flag(name, *value, meaning));
        } else {
          CLI::Option* option = app_->add_option(name, *value, meaning);
          if constexpr (std::is_same_v<Value, std::uint64_t>) {
            option->check(CLI::Validator([](std::string& text) { return RefuseSign(text); }, ""));
          }
          return Option(app_.get(), option);
        }
      },
      target);
}

CommandLine::Option CommandLine::Add(const std::string& name, const config::EnumRef& choice,
                                     const std::string& meaning) {
  const auto take = [choice](const std::string& text) {
    const auto found = std::find(choice.names.begin(), choice.names.end(), text);
    choice.set(static_cast<int>(found - choice.names.begin()));
  };
  CLI::Option* option = app_->add_option_function<std::string>(name, take, meaning);
  option->check(CLI::IsMember(choice.names))
      ->default_str(choice.names.at(static_cast<std::size_t>(choice.get())));
  return Option(app_.get(), option);
}

void CommandLine::Add(const config::Table& table) {
  for (const config::Field& option : table.fields()) {
    fields_.push_back(&option);
    const auto take = [&option](const std::string& text) {
      const auto message = config::ParseText(option, text);
      if (message) throw CLI::ValidationError("--" + option.path, *message);
    };
    const std::string range = config::FormatRange(option);
    const std::string value = config::FormatValue(option.value);
    CLI::Option* declared =
        app_->add_option_function<std::string>("--" + option.path, take, option.meaning);
    if (std::holds_alternative<bool*>(option.value)) {
      // CLI11 uses this text as the value if none is given; the help does not show it.
      declared->expected(0, 1)->default_str("true")->option_text(range + "=" + value);
    } else {
      declared->type_name(range)->default_str(value);
    }
  }
}

void CommandLine::Refuse(const std::string& name, const std::string& why) {
  app_->add_option_function<std::string>(
          name, [name, why](const std::string&) { throw CLI::ValidationError(name, why); }, "")
      ->expected(0, 1)
      ->default_str("")
      ->group("");
}

void CommandLine::RefuseUnread() const {
  for (const config::Field* field : fields_) {
    const std::string name = "--" + field->path;
    const config::Owner* owner = field->Unchosen();
    if (owner == nullptr || app_->count(name) == 0) continue;
    throw CLI::ValidationError(name, owner->WhyUnread("this command", "--"));
  }
}

void CommandLine::AddPlugins() {
  app_->add_option_function<std::vector<std::string>>(
          kPlugin,
          [](const std::vector<std::string>& libraries) {
            for (const std::string& library : libraries) {
              try {
                config::LoadPlugin(library, "");
              } catch (const UserError& error) {
                throw CLI::ValidationError(kPlugin, error.what());
              }
            }
          },
          "shared library with more controllers, reward terms, ... to choose from; repeatable; the "
          "key `plugins` of a scenario does the same")
      ->type_name("LIB")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

int CommandLine::Count(const std::string& name) const {
  return static_cast<int>(app_->count(name));
}

std::optional<int> CommandLine::Parse(int argc, char** argv) {
  try {
    app_->parse(argc, argv);
    RefuseUnread();
    return {};
  } catch (const CLI::ParseError& error) {
    return app_->exit(error) == 0 ? 0 : 2;
  }
}

int CommandLine::Run(int argc, char** argv, const std::function<int()>& body) {
  try {
    if (const std::optional<int> status = Parse(argc, argv)) return *status;
    return body();
  } catch (const UserError& error) {
    return Report(program_, error, 2);
  } catch (const std::exception& error) {
    return Report(program_, error, 1);
  }
}

void LoadPluginArguments(int argc, char** argv) {
  const std::string name = kPlugin;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == name && i + 1 < argc) {
      config::LoadPlugin(argv[++i], name + ": ");
    } else if (argument.rfind(name + "=", 0) == 0) {
      config::LoadPlugin(argument.substr(name.size() + 1), name + ": ");
    }
  }
}

}  // namespace stg
