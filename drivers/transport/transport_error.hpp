#pragma once

#include <stdexcept>

namespace slamd::transport {

/// A socket or a port that cannot be had. One line that names it and the cause.
class TransportError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace slamd::transport
