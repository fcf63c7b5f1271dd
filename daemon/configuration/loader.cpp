#include "daemon/configuration/loader.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include <toml++/toml.h>

#include "daemon/configuration/can.hpp"
#include "drivers/transport/serial_port.hpp"
#include "drivers/transport/udp_receiver.hpp"

namespace slamd::configuration {

namespace {

/// Models that the design names and this release does not read.
const std::set<std::string> kLaterModels{"livox_horizon", "livox_tele15", "livox_mid70"};

[[noreturn]] void fail(const std::string& place, const std::string& path, const std::string& value, const std::string& why) {
  throw ConfigurationError(place + path + (value.empty() ? "" : " = " + value) + ": " + why);
}

/// Writes a value as its author may have: toml++ itself writes 0.1 as 0.10000000000000001.
void write(std::ostream& stream, const toml::node& node) {
  const char* separator = "";
  if (const auto* number = node.as_floating_point()) {
    char text[40];
    stream << std::string_view(text, std::to_chars(text, text + sizeof text, number->get()).ptr);
  } else if (const toml::array* array = node.as_array()) {
    stream << '[';
    for (const toml::node& element : *array) {
      stream << separator;
      write(stream, element);
      separator = ", ";
    }
    stream << ']';
  } else if (const toml::table* table = node.as_table()) {
    stream << '{';
    for (const auto& [key, value] : *table) {
      stream << separator << key.str() << " = ";
      write(stream, value);
      separator = ", ";
    }
    stream << '}';
  } else {
    node.visit([&](const auto& value) { stream << value; });
  }
}

std::string as_text(const toml::node& node) {
  std::ostringstream stream;
  write(stream, node);
  const std::string line = stream.str();
  return line.size() > 60 ? line.substr(0, 57) + "..." : line;
}

/// Says what is wrong with a path that is no key.
std::string why_unknown(const std::string& path) {
  const std::vector<std::string> below = names_below(path);
  if (!below.empty()) {
    std::string line = "must be a table of";
    for (const std::string& name : below) {
      line += (&name == &below.front() ? " " : ", ") + name;
    }
    return line;
  }
  const std::string nearest = nearest_path(path);
  return "unknown key; " + (nearest.empty() ? "docs/configuration.md lists them" : "did you mean " + nearest + "?");
}

double checked_number(const toml::node& node, const Key& key, const std::string& place) {
  const auto number = node.value<double>();
  const bool whole = key.kind != Key::Kind::kInteger || node.is_integer();
  if (!node.is_number() || !number || !whole || !std::isfinite(*number) || *number < key.min || *number > key.max) {
    fail(place, key.path, as_text(node), "must be " + key.allowed());
  }
  return *number;
}

bool read_triple(const toml::node* node, double limit, float (&out)[3]) {
  const toml::array* array = node == nullptr ? nullptr : node->as_array();
  if (array == nullptr || array->size() != 3) {
    return false;
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = (*array)[i].value<double>();
    if (!number || !std::isfinite(*number) || std::abs(*number) > limit) {
      return false;
    }
    out[i] = static_cast<float>(*number);
  }
  return true;
}

Value read_boxes(const toml::node& node, const Key& key, const std::string& place) {
  std::vector<scan::Box> boxes;
  const toml::array* array = node.as_array();
  bool good = array != nullptr && array->size() <= scan::SelfFilter::kMaxBoxes;
  for (std::size_t i = 0; good && i < array->size(); ++i) {
    scan::Box box{};
    const toml::table* table = (*array)[i].as_table();
    good = table != nullptr && table->size() == 2 && read_triple(table->get("min_m"), 1000.0, box.min_m) &&
           read_triple(table->get("max_m"), 1000.0, box.max_m);
    for (int axis = 0; good && axis < 3; ++axis) {
      good = box.min_m[axis] < box.max_m[axis];
    }
    boxes.push_back(box);
  }
  if (!good) {
    fail(place, key.path, as_text(node), "must be " + key.allowed() + ", each min below its max");
  }
  return boxes;
}

Value checked(const toml::node& node, const Key& key, const std::string& place) {
  switch (key.kind) {
    case Key::Kind::kBoolean:
      if (node.is_boolean()) {
        return *node.value<bool>();
      }
      break;
    case Key::Kind::kInteger:
    case Key::Kind::kNumber:
      return checked_number(node, key, place);
    case Key::Kind::kText:
      if (node.is_string()) {
        return *node.value<std::string>();
      }
      break;
    case Key::Kind::kName: {
      const auto name = node.is_string() ? *node.value<std::string>() : std::string();
      const auto allowed = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-'; };
      if (!name.empty() && name.size() <= 40 && std::all_of(name.begin(), name.end(), allowed)) {
        return name;
      }
      break;
    }
    case Key::Kind::kChoice: {
      const auto name = node.is_string() ? node.value<std::string>() : std::nullopt;
      if (key.path == "lidar.model" && name && kLaterModels.count(*name) != 0) {
        fail(place, key.path, as_text(node), "not read by this release; must be " + key.allowed());
      }
      if (name && std::find(key.choices.begin(), key.choices.end(), *name) != key.choices.end()) {
        return *name;
      }
      break;
    }
    case Key::Kind::kVector3: {
      const toml::array* array = node.as_array();
      if (array != nullptr && array->size() == 3) {
        std::vector<double> values;
        for (const toml::node& element : *array) {
          values.push_back(checked_number(element, key, place));
        }
        return values;
      }
      break;
    }
    case Key::Kind::kBoxes:
      return read_boxes(node, key, place);
  }
  fail(place, key.path, as_text(node), "must be " + key.allowed());
}

std::string place_of(const toml::node& node, const std::string& name) {
  return name + ":" + std::to_string(node.source().begin.line) + ": ";
}

/// Calls leaf(path, node) for each key of a table; [[lidar]] counts as one table.
template <typename Leaf>
void walk(const toml::table& table, const std::string& prefix, const std::string& name, Leaf&& leaf) {
  for (const auto& [key, node] : table) {
    const std::string path = prefix.empty() ? std::string(key.str()) : prefix + "." + std::string(key.str());
    if (path == "lidar") {
      const toml::array* lidars = node.as_array();
      if (lidars == nullptr || lidars->empty() || !lidars->front().is_table()) {
        fail(place_of(node, name), path, "", "must be a table in double brackets: [[lidar]]");
      }
      if (lidars->size() > 1) {
        fail(place_of((*lidars)[1], name), path, "", "this release takes exactly one [[lidar]]");
      }
      walk(*lidars->front().as_table(), path, name, leaf);
    } else if (const toml::table* inner = node.as_table(); inner != nullptr && (!inner->empty() || !names_below(path).empty())) {
      walk(*inner, path, name, leaf);
    } else {
      leaf(path, node);
    }
  }
}

bool is_address(const std::string& text) { return transport::parse_address(text).has_value(); }

}  // namespace

void Loader::check_together(const Configuration& configuration, const std::map<std::string, Entry>& entries) {
  const LidarConfiguration& lidar = configuration.lidar;
  const ImuConfiguration& imu = configuration.imu;
  const auto refuse_if = [&](bool wrong, const char* path, const std::string& value, const char* why) {
    if (wrong) {
      const auto entry = entries.find(path);
      fail(entry == entries.end() ? "" : entry->second.place, path, value, why);
    }
  };
  const auto quoted = [](const std::string& text) { return '"' + text + '"'; };
  refuse_if(!is_address(lidar.bind_address), "lidar.bind_address", quoted(lidar.bind_address),
            "must be an IPv4 address with dots, such as \"0.0.0.0\"");
  refuse_if(!lidar.source_address.empty() && !is_address(lidar.source_address), "lidar.source_address",
            quoted(lidar.source_address), "must be an IPv4 address with dots, such as \"192.168.1.201\", or empty");
  if (const std::optional<DeviceFault> fault = device_fault(lidar)) {
    refuse_if(true, fault->path, fault->value, fault->why);
  }
  if (const std::optional<DeviceFault> fault = can_fault(configuration)) {
    refuse_if(true, fault->path, fault->value, fault->why);
  }
  refuse_if(imu.baud != 0 && !transport::SerialPort::is_standard_rate(imu.baud), "imu.baud", std::to_string(imu.baud),
            "must be a standard rate, such as 115200, 230400, 460800 or 921600, or 0");
  const GnssConfiguration& gnss = configuration.gnss;
  refuse_if(gnss.baud != 0 && !transport::SerialPort::is_standard_rate(gnss.baud), "gnss.baud", std::to_string(gnss.baud),
            "must be a standard rate, such as 9600, 38400 or 115200, or 0");
  refuse_if(gnss.is_serial() && gnss.device.empty(), "gnss.source", "\"serial\"",
            "needs gnss.device, the terminal, such as \"/dev/ttyACM0\"");
  refuse_if(gnss.is_velodyne() && (is_livox(lidar.model) || lidar.model == LidarModel::kPoints), "gnss.source",
            "\"velodyne\"", "lidar.model sends no position packets");
  refuse_if(lidar.device.set_utc && !gnss.is_serial(), "lidar.device.set_utc", "true", "needs gnss.source = \"serial\"");
  if (!imu.enabled) {
    return;
  }
  refuse_if(gnss.is_serial() && imu.source == "serial" && gnss.device == imu.device, "gnss.device", quoted(gnss.device),
            "is the terminal of the inertial sensor");
  const bool livox = is_livox(lidar.model);
  const bool mid360 = lidar.model == LidarModel::kLivoxMid360;
  refuse_if(imu.source == "livox" && !livox, "imu.source", "\"livox\"", "lidar.model has no built-in inertial sensor");
  refuse_if(imu.source == "serial" && imu.device.empty(), "imu.source", "\"serial\"",
            "needs imu.device, the terminal, such as \"/dev/ttyUSB0\"");
  refuse_if(imu.source == "serial" && imu.rate_hz != 0 && imu.protocol == imu::Protocol::kCsv, "imu.rate_hz", std::to_string(imu.rate_hz),
            "a sensor that sends CSV rows cannot be told; is for imu.protocol = \"xsens\" or \"mip\"");
  refuse_if(imu.source == "udp" && imu.protocol != imu::Protocol::kCsv, "imu.protocol",
            quoted(name_of(imu.protocol)), "is for imu.source = \"serial\"; \"udp\" takes \"csv\"");
  refuse_if(imu.source == "udp" && (imu.port == lidar.data_port() || (imu.port == lidar.position_port && !livox) ||
                                     (imu.port == lidar.imu_port && mid360)), "imu.port",
            std::to_string(imu.port), "is a port of the LiDAR");
}

std::map<std::string, Loader::Entry> Loader::parse(const std::string& toml_text, const std::string& name) {
  toml::table table;
  try {
    table = toml::parse(toml_text, name);
  } catch (const toml::parse_error& error) {
    std::string why(error.description());
    throw ConfigurationError(name + ":" + std::to_string(error.source().begin.line) + ": not TOML: " + why);
  }
  std::map<std::string, Entry> entries;
  walk(table, "", name, [&](const std::string& path, const toml::node& node) {
    const Key* key = find_key(path);
    if (key == nullptr) {
      fail(place_of(node, name), path, as_text(node), why_unknown(path));
    }
    entries[path] = {checked(node, *key, place_of(node, name)), place_of(node, name)};
  });
  // An [imu] table, even an empty one, says that there is an inertial sensor.
  if (const toml::node* imu = table.get("imu"); imu != nullptr && imu->is_table() && entries.count("imu.enabled") == 0) {
    entries["imu.enabled"] = {true, place_of(*imu, name)};
  }
  return entries;
}

void Loader::add_file(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw ConfigurationError(file.string() + ": cannot be read");
  }
  std::ostringstream text;
  text << stream.rdbuf();
  add_text(text.str(), file.string());
}

void Loader::add_text(const std::string& toml_text, const std::string& name) {
  names_ += (names_.empty() ? "" : ", ") + name;
  for (auto& [path, entry] : parse(toml_text, name)) {
    files_[path] = std::move(entry);
  }
}

void Loader::add_override(const std::string& key_value) {
  const std::size_t equals = key_value.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw ConfigurationError("--set " + key_value + ": must be key=value");
  }
  const std::string path = key_value.substr(0, equals);
  const std::string value = key_value.substr(equals + 1);
  const Key* key = find_key(path);
  if (key == nullptr) {
    throw ConfigurationError("--set " + key_value + ": " + why_unknown(path));
  }
  const bool quoted = key->kind == Key::Kind::kText || key->kind == Key::Kind::kName || key->kind == Key::Kind::kChoice;
  const std::string toml_text = "value = " + (quoted && value.find('"') == std::string::npos ? '"' + value + '"' : value);
  toml::table table;
  try {
    table = toml::parse(toml_text);
  } catch (const toml::parse_error&) {
    table.clear();
  }
  if (table.size() != 1) {  // no value, or several lines
    throw ConfigurationError("--set " + key_value + ": must be " + key->allowed());
  }
  overrides_[path] = {checked(*table.get("value"), *key, "--set "), "--set "};
}

Configuration Loader::load() const {
  std::map<std::string, Entry> merged = files_;
  for (const auto& [path, entry] : overrides_) {
    merged[path] = entry;
  }
  Configuration configuration;
  const auto apply = [&](const std::map<std::string, Entry>& entries) {
    for (const auto& [path, entry] : entries) {
      find_key(path)->set(configuration, entry.value);
    }
  };
  const auto model = merged.find("lidar.model");
  if (model == merged.end()) {
    throw ConfigurationError((names_.empty() ? "" : names_ + ": ") + "lidar.model: missing; must be " +
                             find_key("lidar.model")->allowed() + " (the shortest configuration: [[lidar]] model = \"vlp16\")");
  }
  find_key("lidar.model")->set(configuration, model->second.value);
  apply(parse(preset_of(configuration.lidar.model), std::string("preset ") + name_of(configuration.lidar.model)));
  apply(merged);
  check_together(configuration, merged);
  return configuration;
}

}  // namespace slamd::configuration
