#pragma once

#include <string>

#include "core/base/counter.hpp"

namespace slamd::threads {

/// A thread's sign of life: the rounds of its loop.
/// Threads: rounds.add() by the thread itself, all else by any.  Real-time: one store without a
/// locked instruction.
struct Heartbeat {
  explicit Heartbeat(std::string thread, bool blocks)
      : name(std::move(thread)), may_block(blocks) {}

  const std::string name;
  const bool may_block;  // in a driver, for long: what it does there is no hang
  Counter rounds;
};

}  // namespace slamd::threads
