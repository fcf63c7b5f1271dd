#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "core/base/stamp.hpp"

namespace slamd::service {

/// Keeps a log readable: of one cause one message at once, then how many more there were in a period.
/// Threads: housekeeping.
class RepeatLimit {
 public:
  explicit RepeatLimit(Duration period) : period_(period) {}

  /// Tells whether a message is to be written now. `cause` tells apart what is limited apart; there must be few.
  bool admit(const std::string& cause, const std::string& message, Stamp now) {
    if (period_ == Duration::zero()) {
      return true;
    }
    const auto [entry, is_new] = entries_.try_emplace(cause, Entry{now, 0, {}});
    if (is_new) {
      return true;
    }
    ++entry->second.more;
    entry->second.last = message;
    return false;
  }

  /// Calls say(message, how many of its cause were held back) where a period is over; `all`: without waiting for its end.
  template <typename Say>
  void tell(Stamp now, bool all, Say&& say) {
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      Entry& repeated = entry->second;
      if (!all && now - repeated.begin < period_) {
        ++entry;
      } else if (repeated.more == 0) {
        entry = entries_.erase(entry);  // quiet for a period: the next one is news
      } else {
        say(repeated.last, repeated.more);
        repeated = {now, 0, {}};
        ++entry;
      }
    }
  }

  void set_period(Duration period) { period_ = period; }
  Duration period() const { return period_; }

 private:
  struct Entry {
    Stamp begin{};
    std::uint64_t more = 0;
    std::string last;
  };

  Duration period_;
  std::map<std::string, Entry> entries_;
};

}  // namespace slamd::service
