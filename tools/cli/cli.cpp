#include "tools/cli/cli.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

#include "daemon/configuration/configuration.hpp"

namespace slamd::cli {

namespace {

/// Says what went wrong in one line, whatever breaks the message has.
int complain(const std::string& name, std::string message, int code) {
  message.erase(message.find_last_not_of('\n') + 1);
  std::replace(message.begin(), message.end(), '\n', ' ');
  std::fflush(stdout);
  std::fprintf(stderr, "%s: %s\n", name.c_str(), message.c_str());
  return code;
}

}  // namespace

int run_program(int argc,
                char** argv,
                const std::string& name,
                const std::string& description,
                const std::function<void(const Command&)>& declare,
                const std::function<int()>& run) {
  try {
    CommandLine line(name, description, SLAMD_VERSION);
    declare(line.program());
    if (const std::optional<int> done = line.read(argc, argv)) {
      return *done;
    }
    return run();
  } catch (const UsageError& error) {
    return complain(name, error.what(), 2);
  } catch (const configuration::ConfigurationError& error) {
    return complain(name, error.what(), 2);
  } catch (const std::exception& error) {
    return complain(name, error.what(), 1);
  }
}

Progress::Progress(std::string what)
    : what_(std::move(what)),
      terminal_(isatty(STDERR_FILENO) != 0),
      begin_(std::chrono::steady_clock::now()),
      last_(begin_) {}

Progress::~Progress() {
  if (shown_) {
    std::fprintf(stderr, "\r\033[K");
  }
}

void Progress::say(const std::string& line) {
  std::fprintf(stderr, "%s%s\n", shown_ ? "\r\033[K" : "", line.c_str());
  shown_ = false;
}

void Progress::show(double share) {
  const auto now = std::chrono::steady_clock::now();
  if (!terminal_ || (shown_ && now - last_ < std::chrono::milliseconds(100))) {
    return;
  }
  last_ = now;
  shown_ = true;
  constexpr int kWidth = 30;
  const int filled = static_cast<int>(kWidth * std::clamp(share, 0.0, 1.0));
  const double elapsed_s = std::chrono::duration<double>(now - begin_).count();
  const double left_s = share > 0.01 ? elapsed_s * (1.0 - share) / share : 0.0;
  std::fprintf(stderr,
               "\r%s [%.*s%*s] %3.0f %%  %.0f s left ",
               what_.c_str(),
               filled,
               "##############################",
               kWidth - filled,
               "",
               100.0 * share,
               left_s);
}

}  // namespace slamd::cli
