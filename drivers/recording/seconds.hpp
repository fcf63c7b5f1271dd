#pragma once

#include <optional>
#include <string_view>

#include "core/base/stamp.hpp"

namespace slamd::recording {

/// Reads a time in seconds, as trajectories and times files write it, to the nanosecond: digit by
/// digit, not through a double (which resolves 238 ns of a date). Further digits are cut off.
/// Numbers with an exponent do go through a double. Errors: nothing for what is no number, and for
/// dates beyond 9.2e9 s (the year 2261).
std::optional<Stamp> parse_seconds(std::string_view word);

}  // namespace slamd::recording
