#pragma once

#include <cstddef>
#include <span>

namespace slamd::loop {

/// Returns the weights that are linked in: core/loop/weights/loop_net.bin, byte for byte.
std::span<const std::byte> linked_weights();

}  // namespace slamd::loop
