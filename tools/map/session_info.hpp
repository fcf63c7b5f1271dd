#pragma once

#include <string>

#include "drivers/storage/session_reader.hpp"

namespace slamd::map {

/// Returns what a session holds and what is wrong with it, a line each.
std::string info_text(const storage::Session& session);

/// Returns the same as JSON.
std::string info_json(const storage::Session& session);

}  // namespace slamd::map
