#pragma once

#include <cstdint>
#include <string>

namespace slamd::transport {

// Real-time: no; these read /proc.

/// Names the process that has bound a UDP port: "slamd (pid 123)", or "another process" where that cannot be seen, as of
/// the processes of other users; empty: none has.
std::string owner_of_port(std::uint16_t port);

/// Names a process other than this one that has bound a UDP port, which this one may have bound, too; in the same words.
std::string other_owner_of_port(std::uint16_t port);

/// Names another process that has a terminal open, in the same words; empty: none is seen to.
std::string owner_of_terminal(const std::string& device);

/// Says of a UDP port that it is taken, and by whom: "is taken by slamd (pid 123)".
std::string taken_in_words(std::uint16_t port);

}  // namespace slamd::transport
