// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/option.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace swath::core {

namespace {

std::string bound_text(Dimension d, double si) {
  constexpr size_t short_enough = 8;  // characters
  const std::string exact = format_quantity(d, si);
  const size_t digits = std::min(exact.find(' '), exact.size());
  if (digits <= short_enough) return exact;
  const double value = std::strtod(exact.c_str(), nullptr), large = 1000.0;
  return std::abs(value) < large ? format_number(value, 4) + exact.substr(digits) : exact;
}

}  // namespace

std::string Range::text(Dimension d) const {
  const bool has_low = std::isfinite(lowest);
  const bool has_high = std::isfinite(highest);
  if (has_low && has_high) return (above_lowest ? "> " : "") + bound_text(d, lowest) + " to " + bound_text(d, highest);
  if (has_low) return (above_lowest ? "> " : ">= ") + bound_text(d, lowest);
  if (has_high) return "<= " + bound_text(d, highest);
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
