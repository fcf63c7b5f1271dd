#include "daemon/stages/waiting_scan.hpp"

namespace slamd::stages {

void WaitingScan::keep(const sensor::Scan& scan, Stamp received) {
  is_waiting_ = true;
  received_ = received;
  scan_.index = scan.index;
  scan_.begin = scan.begin;
  scan_.end = scan.end;
  scan_.points_have_time = scan.points_have_time;
  scan_.complete = scan.complete;
  scan_.points_dropped = scan.points_dropped;
  scan_.points.assign(scan.points.view());
}

}  // namespace slamd::stages
