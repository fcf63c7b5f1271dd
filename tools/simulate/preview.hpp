#pragma once

#include "tools/plot/png.hpp"
#include "tools/simulate/scene.hpp"

namespace slamd::simulate {

/// Draws a drive: above, the world from overhead (roofs taken off) with the path and one scan; below, what the driver
/// sees at the moment of the scan. All of it is ray-cast.
plot::IndexedImage preview_of(const Scene& scene, std::size_t width = 960);

}  // namespace slamd::simulate
