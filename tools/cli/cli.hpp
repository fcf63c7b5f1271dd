#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "tools/cli/command.hpp"

namespace slamd::cli {

/// Runs a program with the face that all slamd programs share: --help, --version, one line for what went wrong, and
/// exit codes 0 (done), 1 (could not be done), 2 (bad usage or configuration).
/// `declare` adds the options; `run` does the work and returns the exit code.
int run_program(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<void(const Command&)>& declare, const std::function<int()>& run);

/// A progress bar on the terminal; silent where standard error is none.
class Progress {
 public:
  explicit Progress(std::string what);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Draws the bar. `share` from 0 to 1.
  void show(double share);

  /// Prints a line on standard error, out of the bar's way.
  void say(const std::string& line);

 private:
  std::string what_;
  bool terminal_;
  bool shown_ = false;
  std::chrono::steady_clock::time_point begin_;
  std::chrono::steady_clock::time_point last_;
};

}  // namespace slamd::cli
