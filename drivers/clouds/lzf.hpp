#pragma once

#include <cstddef>
#include <span>

namespace slamd::clouds {

/// The most that one byte of LZF data can unpack to: three bytes make at most 264.
inline constexpr std::size_t kLzfMaxRatio = 88;

/// Unpacks LZF data (the compression of PCD's binary_compressed) so that they fill `out` exactly.
/// Returns false when they do not: too few, too many, or a reference in front of the beginning.
/// Source: the format of liblzf (M. Lehmann), re-implemented from its description.
bool lzf_unpack(std::span<const std::byte> packed, std::span<std::byte> out);

}  // namespace slamd::clouds
