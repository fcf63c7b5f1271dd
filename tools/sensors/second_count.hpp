#pragma once

#include <cstdint>

namespace slamd::sensors {

/// How often something happened: since the beginning, and in the last whole second.
struct Count {
  std::uint64_t total = 0;
  std::uint64_t last_second = 0;

  bool operator==(const Count&) const = default;
};

/// Counts what happens, second by second.
class SecondCount {
 public:
  void add(std::uint64_t events = 1) { this_second_ += events; }

  /// A second is over.
  void end_second() {
    before_ += this_second_;
    last_second_ = this_second_;
    this_second_ = 0;
  }

  Count count() const { return {before_ + this_second_, last_second_}; }

 private:
  std::uint64_t before_ = 0;
  std::uint64_t this_second_ = 0;
  std::uint64_t last_second_ = 0;
};

}  // namespace slamd::sensors
