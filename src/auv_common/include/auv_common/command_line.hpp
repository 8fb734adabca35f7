#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "auv_common/config/plugins.hpp"
#include "auv_common/error.hpp"

namespace stg {

/// Adds the option --plugin. It loads the named library while the command line is parsed.
inline void AddPluginOption(CLI::App* app) {
  app->add_option_function<std::vector<std::string>>(
         "--plugin",
         [](const std::vector<std::string>& libraries) {
           for (const std::string& library : libraries) {
             try {
               config::LoadPlugin(library, "");
             } catch (const UserError& error) {
               throw CLI::ValidationError("--plugin", error.what());
             }
           }
         },
         "shared library with more controllers, reward terms, ... to choose from; repeatable; the "
         "key `plugins` of a scenario does the same")
      ->type_name("LIB")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

/// Loads the libraries that --plugin names, before the command line is parsed. A program calls it
/// if its other options depend on these libraries. Throws UserError.
inline void LoadPluginArguments(int argc, char** argv) {
  const std::string name = "--plugin";
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == name && i + 1 < argc) {
      config::LoadPlugin(argv[++i], name + ": ");
    } else if (argument.rfind(name + "=", 0) == 0) {
      config::LoadPlugin(argument.substr(name.size() + 1), name + ": ");
    }
  }
}

/// Parses the arguments and runs `body`. Returns the exit status: 0 after the help; 2 for refused
/// arguments or input; 1 for another failure; otherwise the result of `body`. The reason of a
/// failure goes to standard error.
/// @param program name of the program, for the messages
template <class Body>
int RunProgram(const std::string& program, CLI::App* app, int argc, char** argv, const Body& body) {
  const auto fail = [&program](const std::exception& error, int status) {
    std::fprintf(stderr, "%s: %s\n", program.c_str(), error.what());
    return status;
  };
  try {
    app->parse(argc, argv);
    return body();
  } catch (const CLI::ParseError& error) {
    return app->exit(error) == 0 ? 0 : 2;
  } catch (const UserError& error) {
    return fail(error, 2);
  } catch (const std::exception& error) {
    return fail(error, 1);
  }
}

}  // namespace stg
