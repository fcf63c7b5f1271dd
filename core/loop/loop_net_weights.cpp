#include "core/loop/loop_net_weights.hpp"

// The assembler takes the file in as it is. CMake says where it is, and rebuilds this when it changes.
// NOLINTNEXTLINE(hicpp-no-assembler): C++20 has no #embed
__asm__(
    ".section .rodata\n"
    ".balign 16\n"
    ".global slamd_loop_net_weights\n"
    ".hidden slamd_loop_net_weights\n"
    "slamd_loop_net_weights:\n"
    ".incbin \"" SLAMD_LOOP_NET_WEIGHTS "\"\n"
    ".global slamd_loop_net_weights_end\n"
    ".hidden slamd_loop_net_weights_end\n"
    "slamd_loop_net_weights_end:\n"
    ".byte 0\n"
    ".text\n");

extern "C" {
extern const std::byte slamd_loop_net_weights[];
extern const std::byte slamd_loop_net_weights_end[];
}

namespace slamd::loop {

std::span<const std::byte> linked_weights() {
  return {slamd_loop_net_weights, slamd_loop_net_weights_end};
}

}  // namespace slamd::loop
