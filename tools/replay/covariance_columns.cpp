#include "tools/replay/covariance_columns.hpp"

namespace slamd::replay {

namespace {

template <typename Visit>
void for_upper_triangle(Visit&& visit) {
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      visit(row, column);
    }
  }
}

}  // namespace

void write_covariance_names(std::FILE* file) {
  for_upper_triangle([&](int row, int column) { std::fprintf(file, ",P%d%d", row, column); });
}

void write_covariance(std::FILE* file, const geometry::Matrix6d& P) {
  for_upper_triangle([&](int row, int column) { std::fprintf(file, ",%.6e", P(row, column)); });
}

}  // namespace slamd::replay
