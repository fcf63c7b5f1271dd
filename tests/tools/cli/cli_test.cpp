#include "tools/cli/cli.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "daemon/configuration/configuration.hpp"

namespace slamd::cli {
namespace {

struct Outcome {
  int code = -1;
  std::string out;
  std::string err;
};

Outcome run(std::vector<std::string> arguments, const std::function<int()>& body) {
  arguments.insert(arguments.begin(), "slamd-sut");
  std::vector<char*> argv;
  for (std::string& argument : arguments) {
    argv.push_back(argument.data());
  }
  Outcome outcome;
  int number = 0;
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  outcome.code = run_program(
      static_cast<int>(argv.size()),
      argv.data(),
      "slamd-sut",
      "Is under test.",
      [&](const Command& app) { app.option("--number", number, "A number"); },
      body);
  outcome.out = testing::internal::GetCapturedStdout();
  outcome.err = testing::internal::GetCapturedStderr();
  return outcome;
}

int done() {
  return 0;
}

TEST(RunProgram, ReturnsWhatTheBodyReturns) {
  const Outcome outcome = run({"--number", "3"}, [] { return 1; });

  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "");
}

TEST(RunProgram, PrintsHelpOnStandardOutput) {
  const Outcome outcome = run({"--help"}, done);

  EXPECT_EQ(outcome.code, 0);
  EXPECT_NE(outcome.out.find("Is under test."), std::string::npos);
  EXPECT_NE(outcome.out.find("--number"), std::string::npos);
  EXPECT_NE(outcome.out.find("--version"), std::string::npos);
}

TEST(RunProgram, PrintsNameAndVersion) {
  const Outcome outcome = run({"--version"}, done);

  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.out.rfind("slamd-sut ", 0), 0U);
}

TEST(RunProgram, NamesAnUnknownArgumentInOneLine) {
  const Outcome outcome = run({"--colour"}, done);

  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err.rfind("slamd-sut: ", 0), 0U);
  EXPECT_NE(outcome.err.find("--colour"), std::string::npos);
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
}

TEST(RunProgram, RefusesAnArgumentOfTheWrongKind) {
  EXPECT_EQ(run({"--number", "three"}, done).code, 2);
}

TEST(RunProgram, TurnsAnExceptionIntoOneLineAndCouldNot) {
  const Outcome outcome =
      run({}, []() -> int { throw std::runtime_error("a.pcap: is\ncut short"); });

  EXPECT_EQ(outcome.code, 1);
  EXPECT_EQ(outcome.err, "slamd-sut: a.pcap: is cut short\n");
}

TEST(RunProgram, TurnsUsageErrorsIntoBadUsage) {
  EXPECT_EQ(run({}, []() -> int { throw UsageError("no"); }).code, 2);
}

TEST(RunProgram, TurnsConfigurationErrorsIntoBadUsage) {
  const Outcome outcome = run(
      {}, []() -> int { throw configuration::ConfigurationError("a.toml:3: odometry.filter"); });

  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "slamd-sut: a.toml:3: odometry.filter\n");
}

TEST(Progress, IsSilentWhereThereIsNoTerminal) {
  testing::internal::CaptureStderr();
  {
    Progress sut("replay");
    sut.show(0.5);
  }

  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace slamd::cli
