#include "drivers/transport/port_owner.hpp"

#include <csignal>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "drivers/transport/datagram_socket.hpp"

namespace slamd::transport {
namespace {

TEST(PortOwner, NamesWhoHasAPort) {
  const DatagramSocket owner(0);

  const std::string sut = owner_of_port(owner.port());

  EXPECT_EQ(sut.find("test_drivers"), 0U) << sut;
  EXPECT_NE(sut.find("(pid " + std::to_string(getpid()) + ")"), std::string::npos) << sut;
}

TEST(PortOwner, NamesNobodyForAPortThatIsFree) {
  std::uint16_t port = 0;
  {
    const DatagramSocket owner(0);
    port = owner.port();
  }

  EXPECT_EQ(owner_of_port(port), "");
}

TEST(PortOwner, NamesWhoElseHasAPort) {
  const DatagramSocket own(0, DatagramSocket::Sharing::kWithOthers);
  EXPECT_EQ(other_owner_of_port(own.port()), "");
  int bound[2];
  ASSERT_EQ(pipe(bound), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(own.fd());  // else it holds this process's socket
    const DatagramSocket other(own.port(), DatagramSocket::Sharing::kWithOthers);
    (void)!write(bound[1], "x", 1);
    pause();
    _exit(0);
  }
  char byte = 0;
  ASSERT_EQ(read(bound[0], &byte, 1), 1);

  const std::string sut = other_owner_of_port(own.port());
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);

  EXPECT_NE(sut.find("(pid " + std::to_string(child) + ")"), std::string::npos) << sut;
  close(bound[0]);
  close(bound[1]);
}

TEST(PortOwner, NamesAnotherProcessThatHasATerminalOpen) {
  const int terminal = posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_EQ(grantpt(terminal), 0);
  ASSERT_EQ(unlockpt(terminal), 0);
  const std::string name = ptsname(terminal);
  int opened[2];
  ASSERT_EQ(pipe(opened), 0);
  const pid_t child = fork();
  if (child == 0) {
    const int fd = open(name.c_str(), O_RDWR | O_NOCTTY);
    (void)!write(opened[1], &fd, sizeof fd);
    pause();
    _exit(0);
  }
  int fd = -1;
  ASSERT_EQ(read(opened[0], &fd, sizeof fd), static_cast<ssize_t>(sizeof fd));
  ASSERT_GE(fd, 0);

  const std::string held = owner_of_terminal(name);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  const int own = open(name.c_str(), O_RDWR | O_NOCTTY);
  const std::string free = owner_of_terminal(name);

  EXPECT_NE(held.find("(pid " + std::to_string(child) + ")"), std::string::npos) << held;
  EXPECT_EQ(free, "");  // but for this process itself
  for (const int end : {own, terminal, opened[0], opened[1]}) {
    close(end);
  }
}

TEST(PortOwner, NamesNobodyForATerminalThatIsNotThere) { EXPECT_EQ(owner_of_terminal("/nowhere/tty"), ""); }

}  // namespace
}  // namespace slamd::transport
