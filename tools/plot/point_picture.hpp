#pragma once

#include <span>

#include <Eigen/Core>

#include "tools/plot/axes.hpp"
#include "tools/plot/png.hpp"

namespace slamd::plot {

/// A picture of points and what it shows.
struct PointPicture {
  IndexedImage image;
  Range across;  // data coordinates of the picture's edges
  Range up;
  Range colour;  // heights of the lowest and the highest colour
};

/// What a point cloud is looked at with.
struct Camera {
  Eigen::Vector3f across = Eigen::Vector3f::UnitX();  // the picture's right
  Eigen::Vector3f up = Eigen::Vector3f::UnitY();      // the picture's up
  double stretch = 1.0;                               // of the picture's up
};

/// The part of the world that a picture shows.
struct Window {
  Range across;
  Range up;
};

/// Returns a window around nearly all points (strays are left out) and all of `path`, with a
/// margin. Errors: throws std::invalid_argument when there are neither points nor path.
Window window_of(std::span<const Eigen::Vector3f> points,
                 std::span<const Eigen::Vector3f> path,
                 const Camera& camera);

/// Draws points on near black, coloured by their z, brighter where there are more; of several in a
/// pixel the highest gives the colour.  Shapes: the picture is `width` pixels wide and as high as
/// the window asks for.
PointPicture picture_of(std::span<const Eigen::Vector3f> points,
                        const Camera& camera,
                        const Window& window,
                        std::size_t width);

}  // namespace slamd::plot
