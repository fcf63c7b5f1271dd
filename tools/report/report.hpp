#pragma once

#include <filesystem>
#include <string>

#include "tools/report/content.hpp"

namespace slamd::report {

/// Returns the report as one HTML document that needs nothing else: no network, no script, pictures
/// included.
std::string html_of(const ReportContent& content);

/// Writes it to a file. Errors: throws std::runtime_error with the file's name.
void write_report(const std::filesystem::path& file, const ReportContent& content);

}  // namespace slamd::report
