// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/units.h"

#include <algorithm>
#include <array>
#include <charconv>

namespace swath::core {

namespace {

using D = Dimension;
// us-ft: 1200/3937 m (US survey foot, withdrawn 2022 but still the unit of State Plane CRSs).
constexpr Unit known_units[] = {
    {"m", D::length, 1.0},
    {"cm", D::length, 1e-2},
    {"mm", D::length, 1e-3},
    {"um", D::length, 1e-6},
    {"nm", D::length, 1e-9},
    {"km", D::length, 1e3},
    {"ft", D::length, 0.3048},
    {"us-ft", D::length, 1200.0 / 3937.0},
    {"deg", D::angle, degree},
    {"rad", D::angle, 1.0},
    {"mrad", D::angle, 1e-3},
    {"urad", D::angle, 1e-6},
    {"arcmin", D::angle, degree / 60.0},
    {"arcsec", D::angle, degree / 3600.0},
    {"gon", D::angle, pi / 200.0},
    {"s", D::time, 1.0},
    {"ms", D::time, 1e-3},
    {"us", D::time, 1e-6},
    {"ns", D::time, 1e-9},
    {"min", D::time, 60.0},
    {"h", D::time, 3600.0},
    {"m/s", D::speed, 1.0},
    {"km/h", D::speed, 1.0 / 3.6},
    {"kn", D::speed, 1852.0 / 3600.0},
    {"mm/s", D::speed, 1e-3},
    {"deg/s", D::rate, degree},
    {"rad/s", D::rate, 1.0},
    {"deg/h", D::rate, degree / 3600.0},
    {"degC", D::temperature, 1.0, 273.15},
    {"K", D::temperature, 1.0},
    {"hPa", D::pressure, 100.0},
    {"Pa", D::pressure, 1.0},
    {"mbar", D::pressure, 100.0},
    {"Hz", D::frequency, 1.0},
    {"kHz", D::frequency, 1e3},
    {"MHz", D::frequency, 1e6},
    {"MB", D::memory, 1e6},
    {"B", D::memory, 1.0},
    {"kB", D::memory, 1e3},
    {"GB", D::memory, 1e9},
    {"MiB", D::memory, 1048576.0},
    {"GiB", D::memory, 1073741824.0},
    {"m/s2", D::acceleration, 1.0},
    {"g", D::acceleration, 9.80665},
    {"mg", D::acceleration, 9.80665e-3},
    {"ug", D::acceleration, 9.80665e-6},
    {"mGal", D::acceleration, 1e-5},
    {"deg/sqrt(h)", D::angular_walk, degree / 60.0},
    {"deg/s/sqrt(Hz)", D::angular_walk, degree},
    {"deg/h/sqrt(Hz)", D::angular_walk, degree / 3600.0},
    {"rad/sqrt(s)", D::angular_walk, 1.0},
    {"m/s/sqrt(h)", D::velocity_walk, 1.0 / 60.0},
    {"m/s/sqrt(s)", D::velocity_walk, 1.0},
    {"mg/sqrt(Hz)", D::velocity_walk, 9.80665e-3},
    {"ug/sqrt(Hz)", D::velocity_walk, 9.80665e-6},
    {"ppm", D::ratio, 1e-6},
    {"%", D::ratio, 1e-2},
    {"uJ", D::energy, 1e-6},
    {"mJ", D::energy, 1e-3},
    {"J", D::energy, 1.0},
};

}  // namespace

const std::vector<Unit>& units() {
  static const std::vector<Unit> list(std::begin(known_units), std::end(known_units));
  return list;
}

std::string_view name_of(Dimension d) {
  switch (d) {
    case Dimension::none:
      return "number";
    case Dimension::length:
      return "length";
    case Dimension::angle:
      return "angle";
    case Dimension::time:
      return "time";
    case Dimension::speed:
      return "speed";
    case Dimension::rate:
      return "angular rate";
    case Dimension::temperature:
      return "temperature";
    case Dimension::pressure:
      return "pressure";
    case Dimension::frequency:
      return "frequency";
    case Dimension::memory:
      return "memory";
    case Dimension::acceleration:
      return "acceleration";
    case Dimension::angular_walk:
      return "angular random walk";
    case Dimension::velocity_walk:
      return "velocity random walk";
    case Dimension::ratio:
      return "ratio";
    case Dimension::energy:
      return "energy";
  }
  return "number";
}

std::string unit_list(Dimension d) {
  std::string out;
  for (const Unit& u : units())
    if (u.dimension == d) out += (out.empty() ? "" : ", ") + std::string(u.name);
  return out;
}

const Unit* find_unit(Dimension d, std::string_view name) {
  constexpr std::string_view survey_foot = "us-ft", as_others_write_it[] = {"ftUS", "US-ft", "ft_us", "usft", "US survey foot"};
  if (std::find(std::begin(as_others_write_it), std::end(as_others_write_it), name) != std::end(as_others_write_it)) name = survey_foot;
  for (const Unit& u : units())
    if (u.dimension == d && u.name == name) return &u;
  return nullptr;
}

std::optional<double> parse_quantity(Dimension d, std::string_view text, std::string& fault) {
  const auto trim = [](std::string_view s) {
    while (!s.empty() && (s.front() == ' ' || s.front() == '\t')) s.remove_prefix(1);
    while (!s.empty() && (s.back() == ' ' || s.back() == '\t')) s.remove_suffix(1);
    return s;
  };
  text = trim(text);
  std::string_view digits = text;
  if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
  double number = 0.0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (code != std::errc()) {
    fault = "'" + std::string(text) + "' does not begin with a number";
    return std::nullopt;
  }
  const std::string_view unit = trim(std::string_view(end, static_cast<size_t>(digits.data() + digits.size() - end)));
  if (!std::isfinite(number)) {
    fault = "'" + std::string(text) + "' is not finite";
    return std::nullopt;
  }
  if (unit.empty()) {
    fault = "no unit: a " + std::string(name_of(d)) + " needs one of " + unit_list(d);
    return std::nullopt;
  }
  if (unit.front() == ',') {
    fault = "'" + std::string(text) + "' has a comma within its number: write a decimal point, and no mark between thousands";
    return std::nullopt;
  }
  const Unit* u = find_unit(d, unit);
  if (!u) {
    fault = "unit '" + std::string(unit) + "' is not a unit of " + std::string(name_of(d)) + " (" + unit_list(d) + ")";
    return std::nullopt;
  }
  return number * u->factor + u->shift;
}

std::string format_number(double v) {
  std::array<char, 40> buf{};
  const auto r = std::to_chars(buf.data(), buf.data() + buf.size(), v);
  return std::string(buf.data(), r.ptr);
}

std::string format_number(double v, int digits) {
  std::array<char, 40> buf{};
  const auto r = std::to_chars(buf.data(), buf.data() + buf.size(), v, std::chars_format::general, digits);
  double rounded = v;
  std::from_chars(buf.data(), r.ptr, rounded);
  return format_number(rounded);
}

std::string counted(std::uint64_t n, std::string_view one, std::string_view many) {
  std::string out = std::to_string(n) + " ";
  if (n == 1) return out.append(one);
  return many.empty() ? out.append(one) + "s" : out.append(many);
}

std::string format_quantity(Dimension d, double si) {
  if (d == Dimension::none) return format_number(si);
  for (const Unit& u : units()) {
    if (u.dimension != d) continue;
    // Rounding to 15 digits hides the conversion's last bit ("0.11 deg", not "0.11000000000000001 deg").
    std::array<char, 40> buf{};
    const auto r = std::to_chars(buf.data(), buf.data() + buf.size(), (si - u.shift) / u.factor, std::chars_format::general, 15);
    double rounded = 0.0;
    std::from_chars(buf.data(), r.ptr, rounded);
    return format_number(rounded) + " " + std::string(u.name);
  }
  return format_number(si);
}

}  // namespace swath::core
