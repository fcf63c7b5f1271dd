// stop_thread PID NAME: holds one thread of a process, as if it hung, until the process has ended. Nothing of the process is
// changed for it: a tracer stops the thread.
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <sys/ptrace.h>
#include <sys/wait.h>

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: stop_thread PID NAME\n");
    return 2;
  }
  for (const auto& task : std::filesystem::directory_iterator(std::string("/proc/") + argv[1] + "/task")) {
    std::string name;
    std::getline(std::ifstream(task.path() / "comm"), name);
    if (name != argv[2]) {
      continue;
    }
    const pid_t thread = std::stoi(task.path().filename());
    if (ptrace(PTRACE_SEIZE, thread, nullptr, nullptr) != 0 || ptrace(PTRACE_INTERRUPT, thread, nullptr, nullptr) != 0) {
      std::fprintf(stderr, "stop_thread: %s: %s\n", argv[2], std::strerror(errno));
      return 1;
    }
    std::printf("stopped %s\n", argv[2]);
    std::fflush(stdout);
    int status = 0;
    while (waitpid(thread, &status, __WALL) == thread && !WIFEXITED(status) && !WIFSIGNALED(status)) {
    }
    return 0;
  }
  std::fprintf(stderr, "stop_thread: no thread %s\n", argv[2]);
  return 1;
}
