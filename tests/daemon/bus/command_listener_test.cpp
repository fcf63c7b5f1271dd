#include "daemon/bus/command_listener.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon/bus/encoding.hpp"

namespace slamd::bus {
namespace {

using std::chrono::milliseconds;

/// A client and a listener on one connection.
struct Bus {
  Bus() {
    connection->subscribe("SLAMD_REPLY", [this](auto bytes) { replies.push_back(decode_reply(bytes).value()); });
  }

  void send(const Command& command) {
    std::array<std::byte, kLargestMessage_bytes> buffer;
    connection->send("SLAMD_COMMAND", {buffer.data(), encode(command, buffer)});
  }

  /// Polls as often as there may be something, 1 s apart.
  std::vector<Command> poll_all() {
    std::vector<Command> commands;
    for (int i = 0; i < 3; ++i) {
      now += std::chrono::seconds(1);
      while (auto command = sut.poll(now)) {
        commands.push_back(*command);
      }
    }
    return commands;
  }

  std::shared_ptr<Connection> connection = std::make_shared<Connection>("memq://");
  CommandListener sut{connection, "SLAMD"};
  CommandListener::Clock::time_point now{std::chrono::hours(1)};
  std::vector<Reply> replies;
};

TEST(CommandListener, HandsOnACommandAndSendsItsAnswer) {
  Bus bus;
  bus.send({.id = 5, .verb = "set-pose", .arguments = {"1", "-2.5", "0", "90"}});

  const auto commands = bus.poll_all();
  ASSERT_EQ(commands.size(), 1U);
  bus.sut.answer({.id = commands[0].id, .ok = true, .text = "done"});
  bus.poll_all();

  EXPECT_EQ(commands[0].verb, "set-pose");
  EXPECT_EQ(commands[0].arguments, (std::vector<std::string>{"1", "-2.5", "0", "90"}));
  ASSERT_EQ(bus.replies.size(), 1U);
  EXPECT_EQ(bus.replies[0].id, 5U);
  EXPECT_TRUE(bus.replies[0].ok);
  EXPECT_EQ(bus.replies[0].text, "done");
}

TEST(CommandListener, HandsOnARepeatedCommandOnce) {
  Bus bus;
  const Command command{.id = 5, .verb = "new-map", .arguments = {}};

  bus.send(command);
  const auto first = bus.poll_all();
  bus.send(command);
  const auto second = bus.poll_all();

  EXPECT_EQ(first.size(), 1U);
  EXPECT_TRUE(second.empty());
  EXPECT_TRUE(bus.replies.empty());
  EXPECT_EQ(bus.sut.counters().repeated, 1U);
}

TEST(CommandListener, AnswersARepeatedCommandAsBefore) {
  Bus bus;
  const Command command{.id = 5, .verb = "new-map", .arguments = {}};
  bus.send(command);
  bus.poll_all();
  bus.sut.answer({.id = 5, .ok = false, .text = "not now"});

  bus.send(command);
  bus.poll_all();
  bus.poll_all();

  ASSERT_EQ(bus.replies.size(), 2U);
  EXPECT_EQ(bus.replies[1].text, "not now");
}

TEST(CommandListener, RefusesInWordsWhatItDoesNotKnow) {
  Bus bus;
  const std::vector<std::pair<Command, std::string>> cases{
      {{.id = 1, .verb = "fly", .arguments = {}}, "unknown command 'fly'"},
      {{.id = 2, .verb = "save", .arguments = {}}, "save takes 1 arguments, not 0"},
      {{.id = 3, .verb = "save", .arguments = {""}}, "save: an argument has 1 to 255 bytes"},
      {{.id = 6, .verb = "save", .arguments = {"../x"}},
       "save: a name has letters, digits, '.', '_' and '-' only, and does not begin with '.'"},
      {{.id = 4, .verb = "set-pose", .arguments = {"1", "2", "3", "north"}}, "set-pose: 'north' is no number"},
      {{.id = 5, .verb = "set-pose", .arguments = {"1", "2", "nan", "0"}}, "set-pose: 'nan' is no number"},
  };
  for (const auto& [command, text] : cases) {
    bus.replies.clear();

    bus.send(command);
    const auto commands = bus.poll_all();
    bus.poll_all();

    EXPECT_TRUE(commands.empty());
    ASSERT_EQ(bus.replies.size(), 1U);
    EXPECT_EQ(bus.replies[0].id, command.id);
    EXPECT_FALSE(bus.replies[0].ok);
    EXPECT_EQ(bus.replies[0].text, text);
  }
  EXPECT_EQ(bus.sut.counters().refused, cases.size());
}

TEST(CommandListener, CountsWhatIsNoCommand) {
  Bus bus;
  const std::vector<std::byte> garbage(3000, std::byte{0x5A});

  bus.connection->send("SLAMD_COMMAND", {garbage.data(), 0});
  bus.connection->send("SLAMD_COMMAND", {garbage.data(), 40});
  bus.connection->send("SLAMD_COMMAND", garbage);

  EXPECT_TRUE(bus.poll_all().empty());
  EXPECT_EQ(bus.sut.counters().malformed, 3U);
}

TEST(CommandListener, HearsItsOwnPrefixOnly) {
  Bus bus;
  std::array<std::byte, kLargestMessage_bytes> buffer;
  const std::size_t size = encode(Command{.id = 1, .verb = "seal", .arguments = {}}, buffer);

  bus.connection->send("OTHER_COMMAND", {buffer.data(), size});
  bus.connection->send("SLAMD_COMMAND2", {buffer.data(), size});

  EXPECT_TRUE(bus.poll_all().empty());
}

TEST(CommandListener, TakesNoMoreThanABurstAtOnce) {
  Bus bus;
  std::size_t taken = 0;
  for (std::uint64_t id = 1; id <= 25; ++id) {
    bus.send({.id = id, .verb = "seal", .arguments = {}});
    taken += bus.sut.poll(bus.now) ? 1 : 0;
  }
  EXPECT_EQ(taken, std::size_t{CommandListener::kBurst});
  EXPECT_EQ(bus.sut.counters().limited, 15U);

  bus.now += std::chrono::seconds(1);
  for (std::uint64_t id = 31; id <= 40; ++id) {
    bus.send({.id = id, .verb = "seal", .arguments = {}});
    taken += bus.sut.poll(bus.now) ? 1 : 0;
  }

  EXPECT_EQ(taken, std::size_t{CommandListener::kBurst + CommandListener::kPerSecond});
}

}  // namespace
}  // namespace slamd::bus
