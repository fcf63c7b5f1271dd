#include "daemon/service/notifier.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>

#include "daemon/service/log.hpp"
#include "tests/daemon/service/service_manager.hpp"

namespace slamd::service {
namespace {

class NotifierTest : public testing::Test {
 protected:
  ~NotifierTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) {
      unsetenv(name);
    }
  }
};

TEST_F(NotifierTest, IsSilentWithoutAManager) {
  Notifier sut;

  sut.ready();

  EXPECT_FALSE(sut.is_heard());
  EXPECT_EQ(sut.patience(), Duration::zero());
}

TEST_F(NotifierTest, TellsTheManagerAtAnAbstractAddress) {
  ServiceManager manager;
  setenv("NOTIFY_SOCKET", manager.address().c_str(), 1);
  Notifier sut;

  sut.status("TRACKING");
  sut.ready();

  EXPECT_EQ(manager.next(), "STATUS=TRACKING");
  EXPECT_EQ(manager.next(), "READY=1");
}

TEST_F(NotifierTest, SaysWhenItBeganToReload) {
  ServiceManager manager;
  setenv("NOTIFY_SOCKET", manager.address().c_str(), 1);
  Notifier sut;

  sut.reloading();

  EXPECT_TRUE(manager.next().starts_with("RELOADING=1\nMONOTONIC_USEC="));
}

TEST_F(NotifierTest, KnowsTheWatchdogThatIsMeantForItself) {
  ServiceManager manager;
  setenv("NOTIFY_SOCKET", manager.address().c_str(), 1);
  setenv("WATCHDOG_USEC", "3000000", 1);

  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_EQ(Notifier().patience(), std::chrono::seconds(3));
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_EQ(Notifier().patience(), Duration::zero());
}

TEST_F(NotifierTest, AsksTheWatchdogForPatience) {
  ServiceManager manager;
  setenv("NOTIFY_SOCKET", manager.address().c_str(), 1);
  setenv("WATCHDOG_USEC", "3000000", 1);
  Notifier sut;

  sut.set_patience(std::chrono::seconds(60));

  EXPECT_EQ(manager.next(), "WATCHDOG_USEC=60000000");
}

TEST_F(NotifierTest, NeverWaitsForAManagerThatDoesNotRead) {
  ServiceManager manager;
  setenv("NOTIFY_SOCKET", manager.address().c_str(), 1);
  Notifier sut;

  for (int i = 0; i < 10'000; ++i) {
    sut.feed();  // a blocking socket would hang here
  }

  EXPECT_EQ(manager.next(), "WATCHDOG=1");
}

TEST(Log, WritesAFieldALine) {
  EXPECT_EQ(journal_entry(Level::kWarning, "two\nlines", {{"SLAMD_STATE", "LOST"}}),
            "MESSAGE=two lines\nPRIORITY=4\nSYSLOG_IDENTIFIER=slamd\nSLAMD_STATE=LOST\n");
}

}  // namespace
}  // namespace slamd::service
