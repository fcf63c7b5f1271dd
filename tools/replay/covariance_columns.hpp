#pragma once

#include <cstdio>

#include "core/geometry/se3.hpp"

namespace slamd::replay {

/// Writes the names of a covariance's columns, P00 to P55: the upper triangle, row by row; each after a comma.
void write_covariance_names(std::FILE* file);

/// Writes the values in the order of the names, each after a comma.
void write_covariance(std::FILE* file, const geometry::Matrix6d& P);

}  // namespace slamd::replay
