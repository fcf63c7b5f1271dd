#pragma once

#include <functional>
#include <string>

#include "daemon/configuration/configuration.hpp"

namespace slamd::service {

/// The life of the daemon: binds, starts the threads, keeps house until SIGTERM or SIGINT, ends cleanly. On SIGHUP it calls
/// `read_again` and takes over what may change. Tells a service manager when it is ready, how it is, and that it lives.
/// Returns the exit code. Errors: those of pipeline::Pipeline.
int serve(const configuration::Configuration& configuration, const std::function<configuration::Configuration()>& read_again);

/// Says what a start would meet here: sockets, buffers, the bus, real-time permissions, a line each.
/// Returns 0 when slamd could start, 1 when not.
int check(const configuration::Configuration& configuration);

/// What is reserved at start, as a table.
std::string memory_plan_text(const configuration::Configuration& configuration);

}  // namespace slamd::service
