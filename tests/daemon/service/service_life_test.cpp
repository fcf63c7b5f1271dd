#include <gtest/gtest.h>
#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "daemon/configuration/loader.hpp"
#include "daemon/service/service.hpp"
#include "tests/daemon/service/service_manager.hpp"

namespace slamd::service {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

configuration::Configuration small_daemon(const std::string& more) {
  configuration::Loader loader;
  loader.add_text(R"(
[[lidar]]
model = "vlp16"
port = 22668
position_port = 28408
bind_address = "127.0.0.1"
[lcm]
url = "memq://"
[map]
max_cells = 1000
)" + more,
                  "test");
  return loader.load();
}

/// The whole daemon as a child of a service manager: what it tells, and what it is seen to do.
class ServiceLife : public testing::Test {
 protected:
  void SetUp() override {
    setenv("NOTIFY_SOCKET", manager_.address().c_str(), 1);
    setenv("WATCHDOG_USEC", "400000", 1);
    child_ = fork();
    if (child_ == 0) {
      unsetenv("WATCHDOG_PID");
      if (freopen("/dev/null", "r", stdin) == nullptr) {  // no terminal: SIGHUP is for us
        _exit(3);
      }
      _exit(serve(small_daemon(""), [] {
        if (std::filesystem::exists("/proc/self/cwd/slamd_test_broken_" +
                                    std::to_string(getpid()))) {
          return small_daemon("[realtime]\npriority = 1000\n");
        }
        return small_daemon("[log]\nrepeat_period_ms = 1.0\n[odometry]\nseed = 2\n");
      }));
    }
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }

  void TearDown() override {
    if (child_ > 0) {
      kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
  }

  /// The id of the child's thread with this name.
  pid_t thread(const std::string& name) const {
    for (const auto& task :
         std::filesystem::directory_iterator("/proc/" + std::to_string(child_) + "/task")) {
      std::string comm;
      std::getline(std::ifstream(task.path() / "comm"), comm);
      if (comm == name) {
        return std::stoi(task.path().filename());
      }
    }
    return 0;
  }

  ServiceManager manager_;
  pid_t child_ = 0;
};

TEST_F(ServiceLife, IsReadyThenFedThenStops) {
  EXPECT_EQ(manager_.wait_for("READY", seconds(20)), "READY=1");
  EXPECT_EQ(manager_.wait_for("STATUS", seconds(5)),
            "STATUS=STARTING: vlp16: nothing received yet");
  EXPECT_EQ(manager_.wait_for("WATCHDOG", seconds(5)), "WATCHDOG=1");

  kill(child_, SIGTERM);

  EXPECT_EQ(manager_.wait_for("STOPPING", seconds(5)), "STOPPING=1");
  int ended = 0;
  waitpid(child_, &ended, 0);
  child_ = 0;
  EXPECT_EQ(ended, 0);
}

TEST_F(ServiceLife, IsNoLongerFedWhileOneThreadStandsStill) {
  ASSERT_EQ(manager_.wait_for("READY", seconds(20)), "READY=1");
  const pid_t tid = thread("slamd-odometry");
  ASSERT_NE(tid, 0);

  // A tracer holds just this thread, as nothing else can.
  ASSERT_EQ(ptrace(PTRACE_SEIZE, tid, nullptr, nullptr), 0);
  ASSERT_EQ(ptrace(PTRACE_INTERRUPT, tid, nullptr, nullptr), 0);
  waitpid(tid, nullptr, __WALL);

  EXPECT_EQ(manager_.wait_for("STATUS=slamd-", seconds(10)),
            "STATUS=slamd-odometry hangs: the service manager will restart slamd");
  EXPECT_EQ(manager_.wait_for("WATCHDOG", milliseconds(500)), "");
  ptrace(PTRACE_DETACH, tid, nullptr, nullptr);
  EXPECT_EQ(manager_.wait_for("WATCHDOG", seconds(10)), "WATCHDOG=1");
}

TEST_F(ServiceLife, ReadsItsConfigurationAgainOnHangUp) {
  ASSERT_EQ(manager_.wait_for("READY", seconds(20)), "READY=1");

  kill(child_, SIGHUP);

  EXPECT_TRUE(manager_.wait_for("RELOADING", seconds(10)).starts_with("RELOADING=1"));
  EXPECT_EQ(manager_.wait_for("READY", seconds(10)), "READY=1");
  EXPECT_EQ(manager_.wait_for("STATUS", seconds(10)),
            "STATUS=STARTING: vlp16: nothing received yet; configuration: waits for a restart: "
            "odometry.seed 1 → 2");
}

TEST_F(ServiceLife, KeepsItsConfigurationWhenTheNewOneIsWrong) {
  ASSERT_EQ(manager_.wait_for("READY", seconds(20)), "READY=1");
  const std::string mark = "slamd_test_broken_" + std::to_string(child_);
  std::ofstream(mark).put('\n');

  kill(child_, SIGHUP);

  EXPECT_EQ(manager_.wait_for("READY", seconds(10)), "READY=1");
  EXPECT_NE(manager_.wait_for("STATUS", seconds(10)).find("configuration refused: test:"),
            std::string::npos);
  EXPECT_EQ(manager_.wait_for("WATCHDOG", seconds(10)), "WATCHDOG=1");
  std::filesystem::remove(mark);
}

}  // namespace
}  // namespace slamd::service
