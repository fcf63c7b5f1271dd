#pragma once

#include <string>
#include <vector>

#include "tools/study/psf_study.hpp"

namespace slamd::study {

/// The tables of an experiment in Markdown: a row for each world and condition, a column for each
/// estimator; once not told and once told. Cells have counts and 95 % intervals in per cent.
std::string markdown_of(const StudyConfig& config, const std::vector<WorldResult>& results);

/// The same as JSON.
std::string json_of(const StudyConfig& config, const std::vector<WorldResult>& results);

/// A chart of an experiment over the size of the errors, all worlds together: successes, or lost
/// runs, in per cent. Lines not told, dashes told.
std::string svg_of(Experiment experiment, const std::vector<WorldResult>& results);

}  // namespace slamd::study
