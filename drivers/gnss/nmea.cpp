#include "drivers/gnss/nmea.hpp"

#include <charconv>
#include <cmath>
#include <cstdio>

#include "core/base/fixed_vector.hpp"

namespace slamd::gnss {

namespace {

constexpr double kMpsPerKnot = 1852.0 / 3600.0;
constexpr double kHighest_m = 100'000.0;
constexpr double kFastest_mps = 10'000.0;

/// The fields of a sentence, its type first; one that cannot be read makes the whole sentence bad.
class Fields {
 public:
  explicit Fields(std::string_view sentence) {
    std::string_view rest = sentence.substr(0, sentence.rfind('*'));
    while (true) {
      const std::size_t comma = rest.find(',');
      if (!fields_.try_push_back(rest.substr(0, comma)) || comma == std::string_view::npos) {
        return;
      }
      rest.remove_prefix(comma + 1);
    }
  }

  std::size_t size() const { return fields_.size(); }
  bool is_good() const { return good_; }
  std::string_view text(std::size_t i) const { return i < fields_.size() ? fields_[i] : std::string_view(); }

  /// A number within the limits; nothing for an empty field.
  std::optional<double> number(std::size_t i, double min, double max) {
    const std::string_view field = text(i);
    if (field.empty()) {
      return std::nullopt;
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    // from_chars takes "inf" and "nan".
    const bool is_one = error == std::errc() && end == field.data() + field.size() && std::isfinite(value);
    return checked(is_one && value >= min && value <= max, value);
  }

  /// hhmmss[.sss]; nothing for an empty field.
  std::optional<Duration> time_of_day(std::size_t i) {
    if (text(i).empty()) {
      return std::nullopt;
    }
    const auto hour = digits(text(i), 0);
    const auto minute = digits(text(i), 2);
    const auto second = digits(text(i), 4);
    const std::optional<Duration> fraction = fraction_of(text(i).size() < 6 ? std::string_view("x") : text(i).substr(6));
    const bool is_one = hour && minute && second && fraction && *hour < 24 && *minute < 60 && *second <= 60;
    return is_one ? checked(true, Duration(std::chrono::hours(*hour) + std::chrono::minutes(*minute) +
                                           std::chrono::seconds(*second)) + *fraction)
                  : checked(false, Duration{});
  }

  /// ddmmyy; nothing for an empty field.
  std::optional<std::chrono::sys_days> date(std::size_t i) {
    if (text(i).empty()) {
      return std::nullopt;
    }
    const auto day = digits(text(i), 0);
    const auto month = digits(text(i), 2);
    const auto year = digits(text(i), 4);
    if (!day || !month || !year || text(i).size() != 6) {
      return checked(false, std::chrono::sys_days{});
    }
    const std::chrono::year_month_day date{std::chrono::year(*year + (*year < 80 ? 2000 : 1900)),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    return checked(date.ok(), date.ok() ? std::chrono::sys_days(date) : std::chrono::sys_days{});
  }

  /// ddmm.mmm,N,dddmm.mmm,E; nothing when all four are empty.
  std::optional<Place> place(std::size_t i) {
    if (text(i).empty() && text(i + 2).empty()) {
      return std::nullopt;
    }
    const auto latitude = angle(i, 90.0, "N", "S");
    const auto longitude = angle(i + 2, 180.0, "E", "W");
    return latitude && longitude ? std::optional(Place{*latitude, *longitude}) : checked(false, Place{});
  }

 private:
  template <typename T>
  std::optional<T> checked(bool good, const T& value) {
    good_ = good_ && good;
    return good ? std::optional<T>(value) : std::nullopt;
  }

  static std::optional<int> digits(std::string_view text, std::size_t at) {
    const auto is_digit = [&](std::size_t i) { return i < text.size() && text[i] >= '0' && text[i] <= '9'; };
    return is_digit(at) && is_digit(at + 1) ? std::optional(10 * (text[at] - '0') + (text[at + 1] - '0')) : std::nullopt;
  }

  /// ".sss" in whole nanoseconds, for a double is none.
  static std::optional<Duration> fraction_of(std::string_view text) {
    if (text.empty()) {
      return Duration{};
    }
    std::int64_t value_ns = 0;
    std::int64_t digit_ns = 100'000'000;
    for (const char c : text.substr(1)) {
      if (c < '0' || c > '9') {
        return std::nullopt;
      }
      value_ns += (c - '0') * digit_ns;
      digit_ns /= 10;
    }
    return text.front() == '.' ? std::optional(Duration(value_ns)) : std::nullopt;
  }

  std::optional<double> angle(std::size_t i, double limit_deg, std::string_view positive, std::string_view negative) {
    const auto value = number(i, 0.0, 100.0 * limit_deg);
    if (!value || (text(i + 1) != positive && text(i + 1) != negative)) {
      return std::nullopt;
    }
    const double degrees = std::floor(*value / 100.0);
    const double minutes = *value - 100.0 * degrees;
    const double result = degrees + minutes / 60.0;
    return checked(minutes < 60.0 && result <= limit_deg, text(i + 1) == negative ? -result : result);
  }

  FixedVector<std::string_view, 24> fields_;
  bool good_ = true;
};

/// Degrees and minutes as sentences have them, with the hemisphere; two empty fields for no value.
std::string angle_text(std::optional<double> value_deg, int digits, char positive, char negative) {
  if (!value_deg) {
    return ",";
  }
  // Rounded as a whole, so that no sentence says 60 minutes.
  const auto units = static_cast<long long>(std::llround(std::abs(*value_deg) * 60.0 * 1e7));
  constexpr long long kUnits = 600'000'000;  // a degree
  char text[48];
  std::snprintf(text, sizeof text, "%0*lld%010.7f,%c", digits, units / kUnits, 1e-7 * static_cast<double>(units % kUnits),
                *value_deg < 0.0 ? negative : positive);
  return text;
}

std::string place_text(const std::optional<Place>& place) {
  return angle_text(place ? std::optional(place->latitude_deg) : std::nullopt, 2, 'N', 'S') + "," +
         angle_text(place ? std::optional(place->longitude_deg) : std::nullopt, 3, 'E', 'W');
}

std::string number_text(const char* format, std::optional<double> value) {
  char text[48] = "";
  if (value) {
    std::snprintf(text, sizeof text, format, *value);
  }
  return text;
}

std::string time_text(std::optional<Duration> time) {
  char text[32] = "";
  if (time) {
    const long long ms = std::chrono::round<std::chrono::milliseconds>(*time).count();
    // A leap second is the 61st of its minute.
    const long long second = std::min(ms / 1000, 86'399LL);
    std::snprintf(text, sizeof text, "%02lld%02lld%02lld.%03lld", second / 3600, second / 60 % 60,
                  second % 60 + (ms / 1000 - second), ms % 1000);
  }
  return text;
}

/// Exclusive or of what stands between '$' and '*'.
unsigned checksum_of(std::string_view body) {
  unsigned sum = 0;
  for (const char c : body) {
    sum ^= static_cast<unsigned char>(c);
  }
  return sum;
}

}  // namespace

bool nmea_checksum_holds(std::string_view sentence) {
  const std::size_t star = sentence.rfind('*');
  if (sentence.empty() || sentence.front() != '$' || star == std::string_view::npos || sentence.size() < star + 3) {
    return false;
  }
  unsigned stated = 0;
  const auto [end, error] = std::from_chars(sentence.data() + star + 1, sentence.data() + star + 3, stated, 16);
  return error == std::errc() && end == sentence.data() + star + 3 && stated == checksum_of(sentence.substr(1, star - 1));
}

std::string_view sentence_type(std::string_view sentence) {
  const bool has_one = sentence.size() >= 7 && sentence[0] == '$' && sentence[1] != 'P' && sentence[6] == ',';
  return has_one ? sentence.substr(3, 3) : std::string_view();
}

std::optional<Rmc> parse_rmc(std::string_view sentence) {
  Fields fields(sentence);
  if (sentence_type(sentence) != "RMC" || !nmea_checksum_holds(sentence) || fields.size() < 10) {
    return std::nullopt;
  }
  Rmc rmc;
  rmc.time_of_day = fields.time_of_day(1);
  rmc.place = fields.place(3);
  rmc.valid = fields.text(2) == "A" && rmc.place;
  if (const auto knots = fields.number(7, 0.0, kFastest_mps / kMpsPerKnot)) {
    rmc.speed_mps = *knots * kMpsPerKnot;
  }
  rmc.course_deg = fields.number(8, 0.0, 360.0);
  if (const auto date = fields.date(9); date && rmc.time_of_day) {
    rmc.utc = sensor::UtcStamp(*date) + *rmc.time_of_day;
  }
  if (const std::string_view mode = fields.text(12); !mode.empty()) {
    rmc.mode = mode.front();
  }
  return fields.is_good() ? std::optional(rmc) : std::nullopt;
}

std::optional<Gga> parse_gga(std::string_view sentence) {
  Fields fields(sentence);
  if (sentence_type(sentence) != "GGA" || !nmea_checksum_holds(sentence) || fields.size() < 12) {
    return std::nullopt;
  }
  Gga gga;
  gga.time_of_day = fields.time_of_day(1);
  gga.place = fields.place(2);
  gga.quality = static_cast<int>(fields.number(6, 0.0, 9.0).value_or(0.0));
  gga.satellites = static_cast<std::uint8_t>(fields.number(7, 0.0, 255.0).value_or(0.0));
  gga.hdop = fields.number(8, 0.0, 1e4);
  gga.altitude_m = fields.number(9, -kHighest_m, kHighest_m);
  gga.separation_m = fields.number(11, -kHighest_m, kHighest_m);
  return fields.is_good() ? std::optional(gga) : std::nullopt;
}

std::optional<Gst> parse_gst(std::string_view sentence) {
  Fields fields(sentence);
  if (sentence_type(sentence) != "GST" || !nmea_checksum_holds(sentence) || fields.size() < 9) {
    return std::nullopt;
  }
  Gst gst;
  gst.time_of_day = fields.time_of_day(1);
  gst.latitude_std_m = fields.number(6, 0.0, 1e9);
  gst.longitude_std_m = fields.number(7, 0.0, 1e9);
  gst.altitude_std_m = fields.number(8, 0.0, 1e9);
  return fields.is_good() ? std::optional(gst) : std::nullopt;
}

std::string framed(std::string_view body) {
  char tail[8];
  std::snprintf(tail, sizeof tail, "*%02X\r\n", checksum_of(body));
  return "$" + std::string(body) + tail;
}

std::string write_rmc(const Rmc& rmc) {
  std::string date;
  if (rmc.utc && rmc.time_of_day) {
    const std::chrono::year_month_day day{std::chrono::floor<std::chrono::days>(*rmc.utc - *rmc.time_of_day)};
    char text[32];
    std::snprintf(text, sizeof text, "%02u%02u%02d", static_cast<unsigned>(day.day()), static_cast<unsigned>(day.month()),
                  static_cast<int>(day.year()) % 100);
    date = text;
  }
  const auto knots = rmc.speed_mps ? std::optional(*rmc.speed_mps / kMpsPerKnot) : std::nullopt;
  return framed("GNRMC," + time_text(rmc.time_of_day) + (rmc.valid ? ",A," : ",V,") + place_text(rmc.place) + "," +
                number_text("%.4f", knots) + "," + number_text("%.3f", rmc.course_deg) + "," + date + ",,," + rmc.mode);
}

std::string write_gga(const Gga& gga) {
  char counts[16];
  std::snprintf(counts, sizeof counts, ",%d,%02u,", gga.quality, gga.satellites);
  return framed("GNGGA," + time_text(gga.time_of_day) + "," + place_text(gga.place) + counts + number_text("%.2f", gga.hdop) +
                "," + number_text("%.3f", gga.altitude_m) + ",M," + number_text("%.3f", gga.separation_m) + ",M,,");
}

std::string write_gst(const Gst& gst) {
  return framed("GNGST," + time_text(gst.time_of_day) + ",,,,," + number_text("%.3f", gst.latitude_std_m) + "," +
                number_text("%.3f", gst.longitude_std_m) + "," + number_text("%.3f", gst.altitude_std_m));
}

}  // namespace slamd::gnss
