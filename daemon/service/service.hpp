#pragma once

#include <string>

#include "daemon/configuration/configuration.hpp"

namespace slamd::service {

/// The life of the daemon: binds, starts the threads, keeps house until SIGTERM or SIGINT, ends cleanly.
/// Returns the exit code. Errors: those of pipeline::Pipeline.
int serve(const configuration::Configuration& configuration);

/// Says what a start would meet here: sockets, buffers, the bus, real-time permissions, a line each.
/// Returns 0 when slamd could start, 1 when not.
int check(const configuration::Configuration& configuration);

/// What is reserved at start, as a table.
std::string memory_plan_text(const configuration::Configuration& configuration);

}  // namespace slamd::service
