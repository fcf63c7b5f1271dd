#pragma once

#include <charconv>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/base/units.hpp"
#include "core/geometry/so3.hpp"
#include "daemon/configuration/key_table.hpp"

/// What the key table is made with. Only for the sources of this folder.
namespace slamd::configuration::keys {


/// Rounds away what a change of units leaves in the last digits, so that what is printed reads back to itself.
inline double rounded(double value) { return std::round(1e9 * value) / 1e9 + 0.0; }

/// Marks a key that the daemon takes over while it runs.
inline Key live(Key key) {
  key.is_live = true;
  return key;
}

/// Stores into, and reads from, any of the types that configuration structs use.
template <typename T>
double to_number(const T& field) {
  if constexpr (std::is_same_v<T, Duration>) {
    return static_cast<double>(field.count()) / 1e6;  // ms
  } else if constexpr (std::is_same_v<T, float>) {
    // The shortest decimal number that names this float: 0.05, not 0.05000000074505806.
    char text[32];
    const auto end = std::to_chars(text, text + sizeof text, field).ptr;
    double value = 0.0;
    std::from_chars(text, end, value);
    return value;
  } else {
    return static_cast<double>(field);
  }
}

template <typename T>
void from_number(T& field, double value) {
  if constexpr (std::is_same_v<T, Duration>) {
    field = from_seconds(1e-3 * value);
  } else {
    field = static_cast<T>(value);
  }
}

/// `field` maps a Configuration to a reference to the member; `unit` is one of the key's unit in the member's.
template <typename Field>
Key number(const std::string& path, double min, double max, const char* help, Field field, double unit = 1.0) {
  using T = std::remove_cvref_t<decltype(field(std::declval<Configuration&>()))>;
  Key key;
  key.path = path;
  key.kind = std::is_integral_v<T> ? Key::Kind::kInteger : Key::Kind::kNumber;
  key.help = help;
  key.min = min;
  key.max = max;
  key.set = [field, unit](Configuration& c, const Value& v) { from_number(field(c), std::get<double>(v) * unit); };
  key.get = [field, unit](const Configuration& c) {
    const double value = to_number(field(const_cast<Configuration&>(c)));
    return Value(unit == 1.0 ? value : rounded(value / unit));
  };
  return key;
}

template <typename Field>
Key boolean(const std::string& path, const char* help, Field field) {
  Key key;
  key.path = path;
  key.kind = Key::Kind::kBoolean;
  key.help = help;
  key.set = [field](Configuration& c, const Value& v) { field(c) = std::get<bool>(v); };
  key.get = [field](const Configuration& c) { return Value(bool(field(const_cast<Configuration&>(c)))); };
  return key;
}

template <typename Field>
Key text(const char* path, const char* help, Field field) {
  Key key;
  key.path = path;
  key.kind = Key::Kind::kText;
  key.help = help;
  key.set = [field](Configuration& c, const Value& v) { field(c) = std::get<std::string>(v); };
  key.get = [field](const Configuration& c) { return Value(std::string(field(const_cast<Configuration&>(c)))); };
  return key;
}

template <typename Field>
Key name(const char* path, const char* help, Field field) {
  Key key = text(path, help, field);
  key.kind = Key::Kind::kName;
  return key;
}

template <typename Enum, typename Field>
Key choice(const std::string& path, const std::vector<std::pair<std::string, Enum>>& names, const char* help, Field field) {
  Key key;
  key.path = path;
  key.kind = Key::Kind::kChoice;
  key.help = help;
  for (const auto& [name, value] : names) {
    key.choices.push_back(name);
  }
  key.set = [field, names](Configuration& c, const Value& v) {
    for (const auto& [name, value] : names) {
      if (name == std::get<std::string>(v)) {
        field(c) = value;
      }
    }
  };
  key.get = [field, names](const Configuration& c) {
    for (const auto& [name, value] : names) {
      if (value == field(const_cast<Configuration&>(c))) {
        return Value(name);
      }
    }
    return Value(std::string());
  };
  return key;
}

inline Key vector3(std::string path, double limit, const char* help, std::function<void(Configuration&, Eigen::Vector3d)> set,
            std::function<std::optional<Eigen::Vector3d>(const Configuration&)> get) {
  Key key;
  key.path = std::move(path);
  key.kind = Key::Kind::kVector3;
  key.help = help;
  key.min = -limit;
  key.max = limit;
  key.set = [set = std::move(set)](Configuration& c, const Value& v) {
    const auto& values = std::get<std::vector<double>>(v);
    set(c, {values[0], values[1], values[2]});
  };
  key.get = [get = std::move(get)](const Configuration& c) {
    const auto v = get(c);
    return Value(v ? std::vector<double>{v->x(), v->y(), v->z()} : std::vector<double>());
  };
  key.optional = true;
  return key;
}

/// The two keys of a transform: xyz_m and rpy_deg, R = Rz(yaw)·Ry(pitch)·Rx(roll).
inline void add_transform(std::vector<Key>& keys,
                   const std::string& path,
                   const char* help,
                   const std::function<geometry::Se3&(Configuration&)>& edit,
                   const std::function<std::optional<geometry::Se3>(const Configuration&)>& read) {
  keys.push_back(vector3(
      path + ".xyz_m", 1000.0, help, [edit](Configuration& c, Eigen::Vector3d v) { edit(c).translation() = v; },
      [read](const Configuration& c) {
        const auto T = read(c);
        return T ? std::optional<Eigen::Vector3d>(T->translation()) : std::nullopt;
      }));
  keys.push_back(vector3(
      path + ".rpy_deg", 360.0, "Its rotation: Rz(yaw)·Ry(pitch)·Rx(roll).",
      [edit](Configuration& c, Eigen::Vector3d v) { edit(c).rotation() = geometry::rotation_from_rpy(v * kDegree); },
      [read](const Configuration& c) {
        const auto T = read(c);
        return T ? std::optional<Eigen::Vector3d>(
                       (geometry::rpy_from_rotation(T->rotation()) / kDegree).unaryExpr(&rounded))
                 : std::nullopt;
      }));
}

}  // namespace slamd::configuration::keys
