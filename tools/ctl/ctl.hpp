#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "daemon/bus/channels.hpp"
#include "daemon/bus/connection.hpp"
#include "daemon/bus/messages.hpp"

namespace slamd::ctl {

struct Options {
  std::string url{bus::kDefaultUrl};
  std::string prefix{bus::kDefaultPrefix};
  double timeout_s = 2.0;
  bus::Command command;  // its id is chosen by main
  bool drives = false;   // instead of the command
  bus::VelocityCommand velocity = {};
  double drive_s = 0.0;
};

/// Sends a command, again and again with the same id, until it is answered.
/// `idle` is called between attempts; for tests.
/// Errors: throws std::runtime_error when nobody answers within options.timeout_s, cli::UsageError for a command that
/// cannot be right, bus::BusError and std::invalid_argument as the bus does.
bus::Reply ask(bus::Connection& connection, const Options& options, const std::function<void()>& idle = [] {});

/// Moves a vehicle: sends a velocity command ten times a second for so long, and then one to stop.
/// `idle` waits until the next one; for tests.
/// Errors: bus::BusError and std::invalid_argument as the bus does.
void drive(bus::Connection& connection, const std::string& prefix, const bus::VelocityCommand& command, double seconds,
           const std::function<void(std::chrono::milliseconds)>& idle);

/// The text without what would move a terminal's cursor.
std::string printable(const std::string& text);

}  // namespace slamd::ctl
