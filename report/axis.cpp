// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/axis.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace swath::report {
namespace {

/// A last tick that rounding puts just beyond the end still counts.
constexpr double rounding = 1e-9;

double power_of_ten(int k) { return std::pow(10.0, k); }

/// 1, 2 or 5 times a power of ten, so that at most `most` of it fit into the length.
double round_step(double length, int most) {
  const double least = length / std::max(most, 1);
  const double decade = power_of_ten(static_cast<int>(std::floor(std::log10(least))));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * decade >= least * (1.0 - rounding)) return factor * decade;
  return 10.0 * decade;
}

std::string fixed(double v, int decimals) {
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::fixed, decimals).ptr;
  return {text, end};
}

/// With the decimals that `step` needs; with an exponent where that takes many digits.
std::string tick_text(double v, double step) {
  if (std::abs(v) < step * rounding) return "0";
  constexpr double smallest = 1e-5, largest = 1e7;
  const int finest = static_cast<int>(std::floor(std::log10(step) + rounding));
  if (step >= smallest && std::abs(v) < largest) return fixed(v, std::max(0, -finest));
  const int digits = std::max(0, static_cast<int>(std::floor(std::log10(std::abs(v)) + rounding)) - finest);
  char text[64];
  const auto end = std::to_chars(text, text + sizeof text, v, std::chars_format::scientific, digits).ptr;
  return {text, end};
}

/// A round number below both ends, where ticks would need too many digits to be distinguished; else 0.
double offset_of(double low, double high, double step) {
  constexpr double many_digits = 1e5;  // the sixth
  constexpr double near = 10.0;        // lengths of the axis; closer to zero an offset would save no digit
  const double size = std::max(std::abs(low), std::abs(high)), length = high - low;
  if (size < many_digits * std::min(step, 1.0) || size < near * length) return 0.0;
  const double round = power_of_ten(static_cast<int>(std::ceil(std::log10(length) - rounding)));
  return std::floor(low / round) * round;
}

/// "time (s)" -> "time since 474000 s (s)".
std::string relative_label(const std::string& label, double offset) {
  const size_t open = label.rfind(" (");
  const bool has_unit = open != std::string::npos && label.back() == ')';
  const std::string name = has_unit ? label.substr(0, open) : label;
  const std::string unit = has_unit ? label.substr(open + 2, label.size() - open - 3) : std::string();
  const bool is_time = name.find("time") != std::string::npos;
  std::string text = name + (name.empty() ? "" : " ") + (is_time ? "since " : "from ");
  const double whole = std::round(offset);
  text += std::abs(whole - offset) < rounding && std::abs(offset) < 1e15 ? fixed(offset, 0) : tick_text(offset, std::abs(offset) * 1e-9);
  return has_unit ? text + " " + unit + " (" + unit + ")" : text;
}

/// `first`: the lowest value shown, which the axis' margin lies below.
void linear_ticks(Axis& a, double first, int most) {
  const double step = round_step(a.high - a.low, most);
  const double offset = offset_of(std::max(first, a.low), a.high, step);
  if (offset != 0.0) a.label = relative_label(a.label, offset);
  // Counted from the offset, so that large values do not round the ticks.
  const double low = a.low - offset, high = a.high - offset;
  for (double n = std::ceil(low / step - rounding); n * step <= high + step * rounding; ++n)
    a.ticks.push_back({offset + n * step, tick_text(n * step, step)});
}

void log_ticks(Axis& a, int most) {
  const int first = static_cast<int>(std::ceil(std::log10(a.low) - rounding));
  const int last = static_cast<int>(std::floor(std::log10(a.high) + rounding));
  constexpr int few = 3;
  if (last - first + 1 < few) {
    for (int k = first - 1; k <= last; ++k)
      for (const double factor : {1.0, 2.0, 5.0}) {
        const double v = factor * power_of_ten(k);
        if (v >= a.low * (1 - rounding) && v <= a.high * (1 + rounding)) a.ticks.push_back({v, tick_text(v, v)});
      }
    if (static_cast<int>(a.ticks.size()) < few) {
      a.ticks.clear();
      linear_ticks(a, a.low, most);
    }
    return;
  }
  const int every = std::max(1, (last - first) / std::max(most, 1) + 1);
  for (int k = first; k <= last; k += every) a.ticks.push_back({power_of_ten(k), tick_text(power_of_ten(k), power_of_ten(k))});
}

}  // namespace

void Reach::add(double v, bool positive) {
  if (!std::isfinite(v) || (positive && v <= 0.0)) return;
  low = any ? std::min(low, v) : v;
  high = any ? std::max(high, v) : v;
  any = true;
}

double Axis::share(double v) const {
  if (!log) return (v - low) / (high - low);
  if (!(v > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  return std::log(v / low) / std::log(high / low);
}

Axis make_axis(const Reach& reach, const std::string& label, int most, double margin, bool log) {
  Axis a;
  a.log = log;
  a.label = label;
  if (log) {
    a.low = reach.empty() ? 0.1 : reach.low;
    a.high = reach.empty() ? 1.0 : reach.high;
    constexpr double least = 1.5;  // factor from end to end
    if (a.high < a.low * least) {
      a.low /= least;
      a.high *= least;
    }
    const double grow = std::pow(a.high / a.low, margin);
    a.low /= grow;
    a.high *= grow;
    log_ticks(a, most);
    return a;
  }
  if (!reach.empty()) {
    // Room for a tick on both sides of a constant, above what a double can distinguish.
    const double size = std::max(std::abs(reach.low), std::abs(reach.high));
    const double least = size > 0.0 ? size * 1e-12 : 1.0;
    const double widen =
        reach.high - reach.low < least ? (size > 0.0 ? std::max(size * 0.05, least) : 1.0) : (reach.high - reach.low) * margin;
    a.low = reach.low - widen;
    a.high = reach.high + widen;
  }
  linear_ticks(a, reach.empty() ? a.low : reach.low, most);
  return a;
}

}  // namespace swath::report
