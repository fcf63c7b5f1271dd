#include "tools/ctl/ctl.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "daemon/bus/command_listener.hpp"
#include "daemon/bus/encoding.hpp"
#include "tools/cli/cli.hpp"

namespace slamd::ctl {
namespace {

const Options kSave{.url = "memq://", .prefix = "SLAMD", .timeout_s = 2.0, .command = {.id = 77, .verb = "save", .arguments = {"a.map"}}};

TEST(Ask, ReturnsTheDaemonsAnswer) {
  const auto connection = std::make_shared<bus::Connection>("memq://");
  bus::CommandListener daemon(connection, "SLAMD");
  const auto poll = [&] {
    if (const auto command = daemon.poll(std::chrono::steady_clock::now())) {
      daemon.answer({.id = command->id, .ok = true, .text = command->verb + " " + command->arguments.at(0)});
    }
  };

  const bus::Reply reply = ask(*connection, kSave, poll);

  EXPECT_TRUE(reply.ok);
  EXPECT_EQ(reply.text, "save a.map");
}

TEST(Ask, RepeatsItselfWithTheSameIdUntilItIsAnswered) {
  bus::Connection connection("memq://");
  std::vector<std::uint64_t> ids;
  connection.subscribe("SLAMD_COMMAND", [&](std::span<const std::byte> message) {
    ids.push_back(bus::decode_command(message).value().id);
    if (ids.size() == 3) {
      std::array<std::byte, bus::kLargestMessage_bytes> buffer;
      connection.send("SLAMD_REPLY", {buffer.data(), bus::encode(bus::Reply{.id = 77, .ok = false, .text = "no"}, buffer)});
    }
  });

  const bus::Reply reply = ask(connection, kSave);

  EXPECT_FALSE(reply.ok);
  EXPECT_EQ(ids, (std::vector<std::uint64_t>{77, 77, 77}));
}

TEST(Ask, DoesNotTakeTheAnswerToSomebodyElse) {
  bus::Connection connection("memq://");
  connection.subscribe("SLAMD_COMMAND", [&](std::span<const std::byte>) {
    std::array<std::byte, bus::kLargestMessage_bytes> buffer;
    connection.send("SLAMD_REPLY", {buffer.data(), bus::encode(bus::Reply{.id = 78, .ok = true, .text = ""}, buffer)});
  });
  Options options = kSave;
  options.timeout_s = 0.2;

  EXPECT_THROW(ask(connection, options), std::runtime_error);
}

TEST(Ask, SaysWhereNobodyAnswers) {
  bus::Connection connection("memq://");
  Options options = kSave;
  options.timeout_s = 0.2;
  options.prefix = "ROBOT2";

  try {
    ask(connection, options);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no answer on memq:// prefix ROBOT2: is slamd running? multicast route?");
  }
}

TEST(Ask, SendsNoCommandThatCannotBeRight) {
  bus::Connection connection("memq://");
  Options options = kSave;
  options.command.verb = "set-pose";

  EXPECT_THROW(ask(connection, options), cli::UsageError);
}

TEST(Drive, RepeatsTheVelocityTenTimesASecondAndEndsWithAStop) {
  bus::Connection connection("memq://");
  std::vector<bus::VelocityCommand> heard;
  connection.subscribe("ROBOT2_VELOCITY_COMMAND", [&](std::span<const std::byte> message) {
    heard.push_back(bus::decode_velocity_command(message).value());
  });
  const auto listen = [&](std::chrono::milliseconds) { connection.wait(std::chrono::milliseconds(0)); };

  drive(connection, "ROBOT2", {.v_mps = 0.5, .w_radps = -0.2}, 2.0, listen);
  listen(std::chrono::milliseconds(0));

  ASSERT_EQ(heard.size(), 21U);
  EXPECT_EQ(heard.front().v_mps, 0.5);
  EXPECT_EQ(heard[19].w_radps, -0.2);
  EXPECT_EQ(heard.back().v_mps, 0.0);
  EXPECT_GT(heard.back().stamp, Stamp{});
}

TEST(Printable, TakesAwayWhatMovesTheCursor) {
  EXPECT_EQ(printable("a\x1b[2Jb\nc"), "a [2Jb c");
}

}  // namespace
}  // namespace slamd::ctl
