#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "daemon/configuration/key_table.hpp"

namespace slamd::configuration {

/// Reads configuration: the model's preset first, then files in the order they are added, then overrides; later ones
/// win key by key. Errors: ConfigurationError, one line with file, line, key, value and what is allowed.
class Loader {
 public:
  /// Adds a TOML file.
  void add_file(const std::filesystem::path& file);

  /// Adds TOML text; `name` stands for the file in messages.
  void add_text(const std::string& toml, const std::string& name);

  /// Adds "key=value", as given with --set.
  void add_override(const std::string& key_value);

  /// Returns what the files say, on top of the model's preset and the defaults.
  Configuration load() const;

 private:
  struct Entry {
    Value value;
    std::string place;  // "file:line: "
  };

  static std::map<std::string, Entry> parse(const std::string& toml, const std::string& name);

  std::string names_;  // of what was added, for messages
  std::map<std::string, Entry> files_;
  std::map<std::string, Entry> overrides_;
};

/// Returns the shipped preset of a model: the text of config/<model>.toml, which is linked in.
const std::string& preset_of(LidarModel model);

}  // namespace slamd::configuration
