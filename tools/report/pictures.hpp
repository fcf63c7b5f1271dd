#pragma once

#include <optional>
#include <string>

#include "tools/report/accuracy.hpp"
#include "tools/report/content.hpp"

namespace slamd::report {

/// What the pictures of a report are drawn from.
struct Scene {
  const ReportContent& content;
  std::optional<Accuracy> run;  // against truth
  std::optional<Accuracy> comparison;
  std::optional<Accuracy> map;
};

/// Returns figures as HTML; those without data are left out (an empty string).
std::string map_figures(const Scene& scene);
std::string path_figures(const Scene& scene);
std::string health_figures(const Scene& scene);

}  // namespace slamd::report
