// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/option.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace swath::core {

namespace {

/// Four digits of a long bound, rounded into the range: what the text allows is allowed.
std::string bound_text(Dimension d, double si, bool is_highest) {
  constexpr size_t short_enough = 8;  // characters
  const std::string exact = format_quantity(d, si);
  const size_t digits = std::min(exact.find(' '), exact.size());
  if (digits <= short_enough) return exact;
  constexpr double large = 1000.0, slack = 1e-6;  // slack: of the last digit
  double value = 0.0;
  std::from_chars(exact.data(), exact.data() + digits, value);
  if (value == 0.0 || !(std::abs(value) < large)) return exact;
  const double step = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 3.0);
  const double steps = is_highest ? std::floor(value / step + slack) : std::ceil(value / step - slack);
  return format_number(steps * step, 4) + exact.substr(digits);
}

}  // namespace

std::string Range::text(Dimension d) const {
  const bool has_low = std::isfinite(lowest);
  const bool has_high = std::isfinite(highest);
  if (has_low && has_high) return (above_lowest ? "> " : "") + bound_text(d, lowest, false) + " to " + bound_text(d, highest, true);
  if (has_low) return (above_lowest ? "> " : ">= ") + bound_text(d, lowest, false);
  if (has_high) return "<= " + bound_text(d, highest, true);
  return "";
}

std::string Shape::text() const {
  std::string one;
  switch (kind) {
    case Kind::boolean:
      one = "true/false";
      break;
    case Kind::integer:
      one = "integer";
      break;
    case Kind::number:
      one = "number";
      break;
    case Kind::quantity:
      one = std::string(name_of(dimension));
      break;
    case Kind::text:
      one = "text";
      break;
    case Kind::path:
      one = "file";
      break;
    case Kind::choice:
      one = "one of ";
      for (size_t i = 0; i < choices.size(); ++i) one += (i ? ", " : "") + choices[i];
  }
  if (length == 0) return "list of " + one;
  if (length > 1) return std::to_string(length) + " x " + one;
  return one;
}

std::optional<Value> read_scalar(const Shape& shape, const Value& given, std::string& fault) {
  const auto wrong = [&](std::string_view wanted) {
    fault = "expected " + std::string(wanted) + ", got " + std::string(given.kind());
    return std::nullopt;
  };
  switch (shape.kind) {
    case Kind::boolean:
      if (!given.is_bool()) return wrong("true or false");
      return given;
    case Kind::integer:
      if (!given.is_int()) return wrong("a whole number");
      return given;
    case Kind::number:
      if (!given.is_number()) return wrong("a number");
      if (!std::isfinite(given.as_number())) {
        fault = "the number is not finite";
        return std::nullopt;
      }
      return Value(given.as_number());
    case Kind::quantity: {
      if (given.is_number()) {
        fault = "no unit: a " + std::string(name_of(shape.dimension)) + " is written with its unit, \"" + format_number(given.as_number()) +
                " " + unit_list(shape.dimension).substr(0, unit_list(shape.dimension).find(',')) + "\" (" + unit_list(shape.dimension) +
                ")";
        return std::nullopt;
      }
      if (!given.is_text()) return wrong("a text with number and unit");
      const auto si = parse_quantity(shape.dimension, given.as_text(), fault);
      if (!si) return std::nullopt;
      return Value(*si);
    }
    case Kind::text:
    case Kind::path:
      if (!given.is_text()) return wrong("a text");
      if (shape.kind == Kind::path && given.as_text().empty()) {
        fault = "the file name is empty";
        return std::nullopt;
      }
      return given;
    case Kind::choice:
      if (!given.is_text()) return wrong(shape.text());
      if (std::find(shape.choices.begin(), shape.choices.end(), given.as_text()) == shape.choices.end()) {
        fault = "'" + given.as_text() + "' is not " + shape.text();
        const std::string near = nearest(given.as_text(), shape.choices);
        if (!near.empty()) fault += "; did you mean '" + near + "'?";
        return std::nullopt;
      }
      return given;
  }
  return std::nullopt;
}

}  // namespace swath::core
