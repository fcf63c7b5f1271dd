#include "tools/cli/interrupts.hpp"

#include <csignal>
#include <initializer_list>

namespace slamd::cli {

namespace {

volatile std::sig_atomic_t interrupted = 0;

}  // namespace

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { interrupted = 1; };
  action.sa_flags = SA_RESETHAND;  // and no SA_RESTART: a sleep ends
  for (const int signal : {SIGINT, SIGTERM}) {
    sigaction(signal, &action, nullptr);
  }
}

bool is_interrupted() { return interrupted != 0; }

}  // namespace slamd::cli
