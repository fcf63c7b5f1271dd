#pragma once

namespace slamd::bench {

/// Moves the calling thread, and all that it starts afterwards, into a network of its own: loopback with a route for
/// multicast and nobody else on it. Returns false where that is not permitted, and changes nothing.
/// Errors: std::system_error when the new network cannot be set up.
bool enter_own_network();

}  // namespace slamd::bench
