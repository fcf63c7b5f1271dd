#pragma once

#include <functional>

#include "tools/replay/network_player.hpp"
#include "tools/replay/recording.hpp"

namespace slamd::replay {

/// Sends a recording's packets to the network with their timing: each at an absolute deadline by its capture stamp; the
/// rows of imu.csv among them by their own stamps, which stay as they are.
/// Errors: RecordingError; std::runtime_error for what the network refuses.
ToNetworkReport send_to_network(const Recording& recording,
                                const ToNetworkOptions& options,
                                SendClock& clock,
                                const std::function<bool()>& stopped,
                                const std::function<void(double share)>& progress);

}  // namespace slamd::replay
