#pragma once

#include "core/sensor/scan.hpp"

namespace slamd::stages {

/// At most one scan that waits for its inertial samples, copied, for the assembler wants its memory back.
/// It hands each scan to process(scan, received) once, in their order.
/// Real-time: allocates in the constructor only.
class WaitingScan {
 public:
  explicit WaitingScan(std::size_t max_points) : scan_(max_points) {}

  bool is_waiting() const { return is_waiting_; }
  const sensor::Scan& scan() const { return scan_; }

  /// Takes a scan in: processes it at once if it is ready, keeps it if not. One that still waits goes first.
  template <typename Ready, typename Process>
  void add(const sensor::Scan& scan, Stamp received, Ready&& ready, Process&& process) {
    flush(process);
    if (ready(scan)) {
      process(scan, received);
    } else {
      keep(scan, received);
    }
  }

  /// Processes the scan that waits, if it is ready.
  template <typename Ready, typename Process>
  void release(Ready&& ready, Process&& process) {
    if (is_waiting_ && ready(scan_)) {
      flush(process);
    }
  }

  /// Processes the scan that waits, ready or not.
  template <typename Process>
  void flush(Process&& process) {
    if (is_waiting_) {
      is_waiting_ = false;
      process(scan_, received_);
    }
  }

 private:
  void keep(const sensor::Scan& scan, Stamp received);

  sensor::Scan scan_;
  Stamp received_{};  // of the packet that completed it
  bool is_waiting_ = false;
};

}  // namespace slamd::stages
