// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <compare>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace swath::core {

/// What a number measures. Inside, every quantity is in the SI unit of its dimension.
enum class Dimension {
  none,           // a bare number
  length,         // m
  angle,          // rad
  time,           // s
  speed,          // m/s
  rate,           // rad/s
  temperature,    // K
  pressure,       // Pa
  frequency,      // Hz
  memory,         // bytes
  acceleration,   // m/s2
  angular_walk,   // rad/sqrt(s), white noise of an angular rate
  velocity_walk,  // m/s/sqrt(s), white noise of a specific force
  ratio,          // 1
  energy,         // J
};

/// A number with its dimension in its type. Construction is explicit; `.value` is SI.
template <Dimension D>
struct Quantity {
  static constexpr Dimension dimension = D;
  double value = 0.0;

  constexpr Quantity() = default;
  constexpr explicit Quantity(double si) : value(si) {}
  constexpr auto operator<=>(const Quantity&) const = default;

  constexpr Quantity operator-() const { return Quantity(-value); }
  constexpr Quantity& operator+=(Quantity o) {
    value += o.value;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity o) {
    value -= o.value;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.value + b.value); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.value - b.value); }
  friend constexpr Quantity operator*(Quantity a, double k) { return Quantity(a.value * k); }
  friend constexpr Quantity operator*(double k, Quantity a) { return Quantity(a.value * k); }
  friend constexpr Quantity operator/(Quantity a, double k) { return Quantity(a.value / k); }
  friend constexpr double operator/(Quantity a, Quantity b) { return a.value / b.value; }
};

using Metres = Quantity<Dimension::length>;
using Radians = Quantity<Dimension::angle>;
using Seconds = Quantity<Dimension::time>;
using MetresPerSecond = Quantity<Dimension::speed>;
using RadiansPerSecond = Quantity<Dimension::rate>;
using Kelvin = Quantity<Dimension::temperature>;
using Pascals = Quantity<Dimension::pressure>;
using Hertz = Quantity<Dimension::frequency>;
using Bytes = Quantity<Dimension::memory>;
using MetresPerSecond2 = Quantity<Dimension::acceleration>;
using AngularWalk = Quantity<Dimension::angular_walk>;
using VelocityWalk = Quantity<Dimension::velocity_walk>;
using Ratio = Quantity<Dimension::ratio>;
using Joules = Quantity<Dimension::energy>;

constexpr double pi = std::numbers::pi;
constexpr double degree = pi / 180.0;
constexpr Radians degrees(double d) { return Radians(d * degree); }
constexpr double to_degrees(Radians r) { return r.value / degree; }
constexpr double to_degrees(double radians) { return radians / degree; }

/// One unit by which a dimension may be written: SI = factor * number + shift.
struct Unit {
  std::string_view name;
  Dimension dimension;
  double factor;
  double shift = 0.0;
};

/// Every unit a config may use. The first of each dimension is the one that values are shown in.
const std::vector<Unit>& units();

/// "length", "angle" ... for messages and schemas.
std::string_view name_of(Dimension d);

/// The units of one dimension, "m, cm, mm, km, ft, us-ft", for messages.
std::string unit_list(Dimension d);

/// The unit of that name in that dimension, or nullptr.
const Unit* find_unit(Dimension d, std::string_view name);

/// Reads "12.5 cm" as SI. `fault` receives the reason where the result is empty
/// (no number, unit missing, unit unknown, unit of another dimension).
std::optional<double> parse_quantity(Dimension d, std::string_view text, std::string& fault);

/// Shortest text that reads back to the same SI value, in the dimension's shown unit ("0.5 m").
std::string format_quantity(Dimension d, double si);

/// Shortest decimal text that reads back to the same double.
std::string format_number(double v);

/// The same of the number rounded to so many significant digits: for messages, where more would say nothing.
std::string format_number(double v, int digits);

/// "1 point", "2 points"; `many`: where it is not `one` with an s, "vertices", "records repeat".
std::string counted(std::uint64_t n, std::string_view one, std::string_view many = {});

}  // namespace swath::core
