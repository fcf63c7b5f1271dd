#pragma once

#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "daemon/configuration/configuration.hpp"

namespace slamd::configuration {

/// What a key can hold.
using Value = std::variant<bool, double, std::string, std::vector<double>, std::vector<scan::Box>>;

/// One key of the configuration: the only place that knows its name, type, range and meaning.
struct Key {
  enum class Kind { kBoolean, kInteger, kNumber, kText, kName, kChoice, kVector3, kBoxes };

  std::string path;  // with dots: "lidar.T_base_lidar.xyz_m"
  Kind kind = Kind::kNumber;
  std::string help;
  double min = 0.0;
  double max = 0.0;
  std::vector<std::string> choices;
  std::function<void(Configuration&, const Value&)> set;
  std::function<Value(const Configuration&)> get;
  bool optional = false;  // left out of print-outs while unset: get gives an empty vector
  bool is_live = false;   // the daemon takes it over on SIGHUP; the others wait for a restart

  /// Says in words what may stand there.
  std::string allowed() const;
};

/// All keys, in the order in which they are printed.
const std::vector<Key>& all_keys();

/// Returns the key with this path, or nullptr.
const Key* find_key(const std::string& path);

/// Returns the known path that is spelt most alike, or an empty string when none is near.
std::string nearest_path(const std::string& path);

/// Returns the keys and tables right below a table ("lidar.T_base_lidar": xyz_m, rpy_deg); none when no key lies below.
std::vector<std::string> names_below(const std::string& table);

/// Prints what a configuration says of a key, as TOML; "unset" where it says nothing.
std::string print_value(const Key& key, const Configuration& configuration);

/// Prints the complete configuration as TOML that reads back to the same configuration.
std::string print_configuration(const Configuration& configuration);

/// Prints the reference of all keys as a Markdown table: docs/configuration.md.
std::string print_reference();

}  // namespace slamd::configuration
