#include "core/occupancy/map_delta.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/bytes.hpp"

namespace slamd::occupancy {

namespace {

/// How a block's states follow: one state for all, runs, or the two planes.
constexpr std::byte kRuns{3};
constexpr std::byte kPlanes{4};
constexpr std::size_t kPlanes_bytes = 2 * kBlockSide * sizeof(std::uint64_t);
constexpr int kLongestRun = 64;

/// What one block takes at most: two numbers, a kind, the planes.
using BlockBytes = FixedVector<std::byte, 10 + 10 + 1 + kPlanes_bytes>;

/// Seven bits a byte, the lowest first; the eighth says that more follow.
void write_number(std::uint64_t number, BlockBytes& out) {
  while (number >= 0x80) {
    out.push_back(static_cast<std::byte>(number | 0x80));
    number >>= 7;
  }
  out.push_back(static_cast<std::byte>(number));
}

std::uint64_t zigzag(std::int64_t value) {
  return (static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63);
}

std::int64_t unzigzag(std::uint64_t value) {
  return static_cast<std::int64_t>((value >> 1) ^ (~(value & 1) + 1));
}

void write_planes(const BlockStates& states, BlockBytes& out) {
  out.push_back(kPlanes);
  const std::size_t at = out.size();
  out.resize(at + kPlanes_bytes);
  const std::span<std::byte> bytes(out.data(), out.size());
  for (std::size_t word = 0; word < kBlockSide; ++word) {
    store_be(bytes, at + 8 * word, states.free[word]);
    store_be(bytes, at + 8 * (kBlockSide + word), states.occupied[word]);
  }
}

/// Writes runs; gives up where the planes are shorter.
void write_states(const BlockStates& states, BlockBytes& out) {
  const std::size_t begin = out.size();
  const auto is_all = [](const auto& plane, std::uint64_t word) { return std::all_of(plane.begin(), plane.end(), [word](std::uint64_t w) { return w == word; }); };
  for (const CellState state : {CellState::kUnknown, CellState::kFree, CellState::kOccupied}) {
    if (is_all(states.free, state == CellState::kFree ? ~std::uint64_t{0} : 0) && is_all(states.occupied, state == CellState::kOccupied ? ~std::uint64_t{0} : 0)) {
      out.push_back(static_cast<std::byte>(state));
      return;
    }
  }
  out.push_back(kRuns);
  for (int place = 0; place < kBlockCells;) {
    const CellState state = states.at(place);
    int length = 1;
    while (length < kLongestRun && place + length < kBlockCells && states.at(place + length) == state) {
      ++length;
    }
    if (out.size() - begin > kPlanes_bytes) {
      out.resize(begin);
      write_planes(states, out);
      return;
    }
    out.push_back(static_cast<std::byte>((static_cast<unsigned>(state) << 6U) | static_cast<unsigned>(length - 1)));
    place += length;
  }
}

}  // namespace

BlockWriter::BlockWriter(MapDelta& message) : message_(message), number_(message.covers.from) {
  message_.blocks = 0;
  message_.payload.clear();
}

bool BlockWriter::add(const SentBlock& block) {
  const std::int32_t place = message_.window.place_of(block.index);
  BlockBytes bytes;
  write_number(block.number - number_ - 1, bytes);
  write_number(zigzag(std::int64_t{place} - place_), bytes);
  write_states(block.states, bytes);
  const std::size_t size = message_.payload.size();
  if (size + bytes.size() > MapDelta::kPayload_bytes) {
    return false;
  }
  message_.payload.resize(size + bytes.size());
  std::copy(bytes.begin(), bytes.end(), message_.payload.begin() + size);
  ++message_.blocks;
  number_ = block.number;
  place_ = place;
  return true;
}

std::optional<std::uint64_t> BlockReader::read_number() {
  std::uint64_t number = 0;
  for (unsigned shift = 0; shift < 63; shift += 7) {
    if (at_ == message_.payload.size()) {
      return std::nullopt;
    }
    const auto byte = std::to_integer<std::uint64_t>(message_.payload[at_++]);
    number |= (byte & 0x7FU) << shift;
    if (byte < 0x80) {
      return number;
    }
  }
  return std::nullopt;
}

std::optional<BlockStates> BlockReader::read_states() {
  BlockStates states;
  if (at_ == message_.payload.size()) {
    return std::nullopt;
  }
  const std::byte kind = message_.payload[at_++];
  if (kind < kRuns) {
    states.free.fill(kind == std::byte{1} ? ~std::uint64_t{0} : 0);
    states.occupied.fill(kind == std::byte{2} ? ~std::uint64_t{0} : 0);
    return states;
  }
  if (kind == kPlanes) {
    if (message_.payload.size() - at_ < kPlanes_bytes) {
      return std::nullopt;
    }
    const auto bytes = message_.payload.view();
    for (std::size_t word = 0; word < kBlockSide; ++word) {
      states.free[word] = load_be<std::uint64_t>(bytes, at_ + 8 * word);
      states.occupied[word] = load_be<std::uint64_t>(bytes, at_ + 8 * (kBlockSide + word));
      if ((states.free[word] & states.occupied[word]) != 0) {
        return std::nullopt;
      }
    }
    at_ += kPlanes_bytes;
    return states;
  }
  if (kind != kRuns) {
    return std::nullopt;
  }
  for (int place = 0; place < kBlockCells;) {
    if (at_ == message_.payload.size()) {
      return std::nullopt;
    }
    const auto run = std::to_integer<unsigned>(message_.payload[at_++]);
    const int end = place + static_cast<int>(run & 63U) + 1;
    if (run >> 6U > 2 || end > kBlockCells) {
      return std::nullopt;
    }
    for (; place < end; ++place) {
      states.set(place, static_cast<CellState>(run >> 6U));
    }
  }
  return states;
}

std::optional<SentBlock> BlockReader::next() {
  const auto skipped = read_number();
  const auto moved = skipped ? read_number() : std::nullopt;
  const auto states = moved ? read_states() : std::nullopt;
  if (!states || *skipped >= message_.covers.to - number_) {
    return std::nullopt;
  }
  const std::int64_t step = unzigzag(*moved);
  const auto blocks = static_cast<std::int64_t>(message_.window.blocks());
  if (step <= -blocks || step >= blocks || place_ + step < 0 || place_ + step >= blocks) {
    return std::nullopt;
  }
  number_ += *skipped + 1;
  place_ += step;
  return SentBlock{number_, message_.window.block_of_place(static_cast<std::int32_t>(place_)), *states};
}

bool is_well_formed(const MapDelta& message) {
  constexpr std::int32_t kFarthest = 1 << 27;  // as far as cell_of() goes: the cells of a window there fit 32 bits
  const auto is_within = [](std::int32_t i) { return i >= -kFarthest && i <= kFarthest; };
  const auto is_near = [&](const BlockIndex& block) { return is_within(block.x) && is_within(block.y) && is_within(block.z); };
  const auto& size = message.window.size;
  if (!(message.cell_m >= 0.01 && message.cell_m <= 10.0) || !is_near(message.window.first) || !is_near(message.anchor) || message.submap < -1 ||
      std::any_of(size.begin(), size.end(), [](std::int32_t side) { return side < 1 || side > kLongestSide; }) ||
      message.window.blocks() > kMostBlocks || message.covers.from > message.covers.to || message.covers.to > message.newest ||
      message.newest > (std::uint64_t{1} << 62)) {
    return false;
  }
  BlockReader reader(message);
  std::uint16_t blocks = 0;
  std::size_t used = 0;
  while (const auto block = reader.next()) {
    ++blocks;
    used = reader.used_bytes();
  }
  return blocks == message.blocks && used == message.payload.size();
}

}  // namespace slamd::occupancy
