#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace stg {

namespace config {
struct EnumRef;
struct Field;
class Table;
}  // namespace config

/// The options and arguments of a program, with a help page. CLI11 parses them. Its headers take
/// seconds to compile, so only command_line.cpp includes them.
class CommandLine {
 public:
  /// Variable that receives a value; its present value is the default. A bool is a flag without a
  /// value. A seed (std::uint64_t) must not be negative; CLI11 would turn -1 into 2^64 - 1.
  using Target = std::variant<bool*, int*, double*, std::uint64_t*, std::string*,
                              std::vector<std::string>*, std::vector<double>*>;

  /// A declared option; its functions say more about it.
  class Option {
   public:
    Option& Required();
    Option& ShowDefault();  ///< the help shows the default
    Option& From(int lo, int hi);
    Option& OneOf(const std::vector<std::string>& names);
    Option& Values(int count);    ///< exactly so many values follow
    Option& OneValuePerUse();     ///< it may be given several times, with one value each time
    Option& SplitAt(char comma);  ///< one value may contain several, separated by this character
    Option& Needs(const std::string& name);   ///< refused without that option, declared before
    Option& Group(const std::string& title);  ///< part of the help page

   private:
    friend class CommandLine;
    Option(CLI::App* app, CLI::Option* option) : app_(app), option_(option) {}
    CLI::App* app_;
    CLI::Option* option_;
  };

  /// @param program name of the program, for the messages
  CommandLine(std::string program, const std::string& description);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// @param name "--name" for an option, "name" for an argument without a name
  Option Add(const std::string& name, Target target, const std::string& meaning);
  /// An option with one of the names. The help lists them and shows the default.
  Option Add(const std::string& name, const config::EnumRef& choice, const std::string& meaning);
  /// Adds an option "--path VALUE" for each field of the table. The value of a flag may be omitted.
  /// An option of a thing that was not chosen is refused. The table must exist until the command
  /// line is parsed.
  void Add(const config::Table& table);
  /// Refuses an option, with or without a value. The help does not show it.
  /// @param why the end of the message "--name: why"
  void Refuse(const std::string& name, const std::string& why);
  /// Adds the option --plugin. It loads the named library while the command line is parsed.
  void AddPlugins();

  /// How often an option was given.
  int Count(const std::string& name) const;

  /// Returns nothing if the program can go on. Otherwise returns the exit status: 0 after the help,
  /// 2 for refused arguments; the reason is on standard error.
  std::optional<int> Parse(int argc, char** argv);
  /// Parses the arguments and runs `body`. Returns the exit status: 0 after the help; 2 for refused
  /// arguments or input; 1 for another failure; otherwise the result of `body`. The reason of a
  /// failure goes to standard error.
  int Run(int argc, char** argv, const std::function<int()>& body);

 private:
  void RefuseUnread() const;

  std::string program_;
  std::unique_ptr<CLI::App> app_;
  std::vector<const config::Field*> fields_;  ///< of all tables
};

/// Loads the libraries that --plugin names, before the command line is parsed. A program calls it
/// if its other options depend on these libraries. Throws UserError.
void LoadPluginArguments(int argc, char** argv);

}  // namespace stg
