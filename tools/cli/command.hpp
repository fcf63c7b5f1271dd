#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace slamd::cli {

/// Bad usage: one line; the program exits with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An option or argument that a command has, while it is declared. A handle: copies mean the same option.
/// CLI11 reads the command line; these classes keep it, which takes long to compile, in one source.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  Option required() const;

  /// The help shows the variable's value as the default; or `text`.
  Option shows_default() const;
  Option shows_default(const std::string& text) const;

  /// The help calls the value so.
  Option value_name(const std::string& name) const;

  /// The help names no kind of value behind the argument.
  Option unlabelled() const;

  // What is allowed; anything else is bad usage, said in one line.
  Option within(double least, double most) const;
  Option within(int least, int most) const;
  Option zero_or_within(double least, double most) const;
  Option positive() const;
  Option one_of(const std::vector<std::string>& values) const;
  Option existing_file() const;
  Option excludes(std::initializer_list<const char*> names) const;
  Option needs(const Option& other) const;

  /// Given several times, all values count.
  Option take_all() const;

  /// Exactly `count` values, in one argument, with commas between them.
  Option commas(int count) const;

 private:
  CLI::Option* option_;
};

/// A program's command line, or one of the commands that it has. A handle likewise; a default one means none.
class Command {
 public:
  Command() = default;
  explicit Command(CLI::App* app) : app_(app) {}

  /// The same command: the help lists what is declared through it under this heading.
  Command under(const std::string& heading) const;

  /// A value: a name that begins with "--", or the name of an argument that stands by itself. `value` outlives the parsing.
  /// T: std::string, std::filesystem::path, int, double, float, std::uint64_t, or a vector of std::string, int, double,
  /// std::uint16_t or std::uint64_t.
  template <typename T>
  Option option(const std::string& name, T& value, const std::string& help) const;

  /// True when given; with "!--name", false when given.
  Option flag(const std::string& name, bool& value, const std::string& help) const;

  /// Does something as soon as it is read, whatever else stands on the line.
  Option action(const std::string& name, const std::function<void()>& act, const std::string& help) const;

  /// A command of its own, with options of its own.
  Command command(const std::string& name, const std::string& help) const;

  /// One of the commands must be given.
  void require_command() const;

  /// The options of the program may stand behind the command, too.
  void takes_outer_options() const;

  /// Called when the command is given, once its options are read.
  void when_given(const std::function<void()>& act) const;

  /// What the help ends with.
  void footer(const std::string& text) const;

  /// Tells whether the line that was read has this command.
  bool is_given() const;

  /// The name of the command that was given.
  std::string given_command() const;

 private:
  Option listed(CLI::Option* option) const;

  CLI::App* app_ = nullptr;
  std::string heading_;  // empty: CLI11's own
};

/// What a program is called with.
class CommandLine {
 public:
  CommandLine(const std::string& name, const std::string& description, const std::string& version);
  ~CommandLine();

  /// What is declared here is read.
  Command program() const;

  /// Reads it into the variables that are declared. Returns the exit code where that is all there is to do: help, version.
  /// Errors: UsageError.
  std::optional<int> read(int argc, char** argv);

 private:
  std::unique_ptr<CLI::App> app_;
};

}  // namespace slamd::cli
