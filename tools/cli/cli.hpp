#pragma once

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>

namespace CLI {
class App;
}

namespace slamd::cli {

/// Bad usage: one line; the program exits with 2.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Runs a program with the face that all slamd programs share: --help, --version, one line for what went wrong, and
/// exit codes 0 (done), 1 (could not be done), 2 (bad usage or configuration).
/// `declare` adds the options; `run` does the work and returns the exit code.
int run_program(int argc, char** argv, const std::string& name, const std::string& description,
                const std::function<void(CLI::App&)>& declare, const std::function<int()>& run);

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
