#pragma once

#include <cstdint>
#include <string>

namespace slamd::transport {

/// Says of a UDP port that it is taken, and by whom: "is taken by slamd (pid 123)", or "by another process" where that
/// cannot be seen, as of the processes of other users.
/// Real-time: no; reads /proc.
std::string taken_in_words(std::uint16_t port);

}  // namespace slamd::transport
