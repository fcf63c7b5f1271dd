#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <type_traits>

namespace slamd {

/// Shows the newest value of one thread to all others, whole: a seqlock with two slots.
///
/// The writer fills the slot that is not shown, then shows it; a reader that finds the version
/// changed while it copied looks again. So a reader never waits for a writer that was interrupted
/// in the middle of a store (with one slot, a reader of higher real-time priority would spin on it
/// for ever).
/// Threads: store() by one writer; load() and version() by any.
/// Real-time: store() is wait-free; load() repeats only when a store was completed meanwhile. Never
/// allocates.
template <typename T>
class Latest {
  static_assert(std::is_trivially_copyable_v<T> && std::is_default_constructible_v<T>);

 public:
  void store(const T& value) {
    const std::uint64_t version = version_.load(std::memory_order_relaxed) + 1;
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof(T));
    Slot& slot = slots_[version % 2];
    for (std::size_t i = 0; i < kWords; ++i) {
      // Release: who sees this word also sees the version before it, by which this slot was no
      // longer shown.
      slot[i].store(words[i], std::memory_order_release);
    }
    version_.store(version, std::memory_order_release);
  }

  /// The newest value, or nothing before the first store.
  std::optional<T> load() const {
    std::array<std::uint64_t, kWords> words;
    std::uint64_t version = version_.load(std::memory_order_acquire);
    while (version != 0) {
      const Slot& slot = slots_[version % 2];
      for (std::size_t i = 0; i < kWords; ++i) {
        // Acquire: the counterpart of the release above, and the version below is read after it.
        words[i] = slot[i].load(std::memory_order_acquire);
      }
      const std::uint64_t version_after = version_.load(std::memory_order_acquire);
      if (version == version_after) {
        T value;
        std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
        return value;
      }
      version = version_after;
    }
    return std::nullopt;
  }

  /// How many values have been stored.
  std::uint64_t version() const { return version_.load(std::memory_order_acquire); }

 private:
  static constexpr std::size_t kWords =
      (sizeof(T) + sizeof(std::uint64_t) - 1) / sizeof(std::uint64_t);
  using Slot = std::array<std::atomic<std::uint64_t>, kWords>;

  // Both written by the writer, read by all.
  std::atomic<std::uint64_t> version_{0};  // slots_[version_ % 2] is shown; 0: none yet
  std::array<Slot, 2> slots_{};
};

}  // namespace slamd
