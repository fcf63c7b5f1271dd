#include "drivers/imu/protocol.hpp"

namespace slamd::imu {

const char* name_of(Protocol protocol) {
  switch (protocol) {
    case Protocol::kCsv: return "csv";
    case Protocol::kXsens: return "xsens";
    case Protocol::kMip: return "mip";
    case Protocol::kAceinna: return "aceinna";
  }
  return "?";
}

}  // namespace slamd::imu
