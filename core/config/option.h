// SPDX-License-Identifier: GPL-3.0-or-later
// The one declaration per option. A struct of options has a free function
//
//   template <class V> void describe(SmrfOptions& o, V& v) {
//     v.option("cell", o.cell, above(0.0), "Side of one raster cell.", "Pingel2013 2.1");
//     v.check(o.window >= o.cell, "window must span at least one cell");
//   }
//
// found by argument-dependent lookup, and every visitor (reading, help, schema, docs, explain, fingerprint)
// is made from it. See option_visitors.h for the visitors.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/units.h"
#include "core/config/value.h"

namespace swath::core {

/// The numbers an option accepts, in SI.
struct Range {
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();
  bool above_lowest = false;  ///< the lowest value itself is not allowed

  bool holds(double v) const { return (above_lowest ? v > lowest : v >= lowest) && v <= highest; }
  /// "> 0 m", "0 to 5", "" for any, in the dimension's shown unit; four digits of a bound that is not round there (57.3 deg of 1 rad).
  std::string text(Dimension d) const;
};
inline Range any() { return {}; }
inline Range above(double lowest) { return {lowest, std::numeric_limits<double>::infinity(), true}; }
inline Range at_least(double lowest) { return {lowest, std::numeric_limits<double>::infinity(), false}; }
inline Range within(double lowest, double highest) { return {lowest, highest, false}; }
inline Range above_to(double lowest, double highest) { return {lowest, highest, true}; }
/// Of an angle: a whole turn at most, either way.
inline Range one_turn() { return within(-2.0 * pi, 2.0 * pi); }

/// What an option holds.
enum class Kind { boolean, integer, number, quantity, text, path, choice };

/// The shape of an option's value: a scalar of a kind, or a list of such scalars.
struct Shape {
  Kind kind = Kind::text;
  Dimension dimension = Dimension::none;
  int length = 1;         ///< 1 scalar, n > 1 a list of exactly n, 0 a list of any length
  bool optional = false;  ///< may be left out and then has no value at all
  std::vector<std::string> choices{};

  /// "length", "3 lengths", "list of texts", "one of first, last" ...
  std::string text() const;
};

/// Names of an enum's values, in order; specialise for each enum that is an option:
///   template <> struct Choices<Mode> { static constexpr std::array<std::string_view, 2> names{"first", "last"}; };
template <class E>
struct Choices;

/// Reads one scalar (not a list) of the shape: the result, or `fault` says why not. Text is returned as it is.
std::optional<Value> read_scalar(const Shape& shape, const Value& given, std::string& fault);

/// How a C++ type is an option: its shape, its value as a config would write it, and back.
/// `set` takes a scalar that read_scalar has checked: SI doubles, int64, bool, string.
template <class T>
struct Codec;

template <>
struct Codec<bool> {
  static Shape shape() { return {Kind::boolean}; }
  static Value get(bool v) { return v; }
  static void set(bool& o, const Value& v) { o = v.as_bool(); }
};
template <std::integral T>
requires(!std::same_as<T, bool>) struct Codec<T> {
  static Shape shape() { return {Kind::integer}; }
  static Value get(T v) { return static_cast<std::int64_t>(v); }
  static void set(T& o, const Value& v) { o = static_cast<T>(v.as_int()); }
};
template <>
struct Codec<double> {
  static Shape shape() { return {Kind::number}; }
  static Value get(double v) { return v; }
  static void set(double& o, const Value& v) { o = v.as_number(); }
};
template <Dimension D>
struct Codec<Quantity<D>> {
  static Shape shape() { return {Kind::quantity, D}; }
  static Value get(Quantity<D> v) { return format_quantity(D, v.value); }
  static void set(Quantity<D>& o, const Value& v) { o.value = v.as_number(); }
};
template <>
struct Codec<std::string> {
  static Shape shape() { return {Kind::text}; }
  static Value get(const std::string& v) { return v; }
  static void set(std::string& o, const Value& v) { o = v.as_text(); }
};
template <>
struct Codec<std::filesystem::path> {
  static Shape shape() { return {Kind::path}; }
  /// As it is written: generic_string() would make "s3:/bucket/a.laz" of an address.
  static Value get(const std::filesystem::path& v) { return v.string(); }
  static void set(std::filesystem::path& o, const Value& v) { o = v.as_text(); }
};
template <class E>
requires std::is_enum_v<E>
struct Codec<E> {
  static Shape shape() {
    Shape s{Kind::choice};
    s.choices.assign(Choices<E>::names.begin(), Choices<E>::names.end());
    return s;
  }
  static Value get(E e) { return Choices<E>::names.at(static_cast<size_t>(e)); }
  static void set(E& e, const Value& v) {
    for (size_t i = 0; i < Choices<E>::names.size(); ++i)
      if (Choices<E>::names[i] == v.as_text()) e = static_cast<E>(i);
  }
};
template <class T>
struct Codec<std::optional<T>> {
  static Shape shape() {
    Shape s = Codec<T>::shape();
    s.optional = true;
    return s;
  }
  static Value get(const std::optional<T>& v) { return v ? Codec<T>::get(*v) : Value{}; }
  static void set(std::optional<T>& o, const Value& v) { Codec<T>::set(o.emplace(), v); }
};
template <class T, size_t N>
struct Codec<std::array<T, N>> {
  static Shape shape() {
    Shape s = Codec<T>::shape();
    s.length = static_cast<int>(N);
    return s;
  }
  static Value get(const std::array<T, N>& a) {
    Value out = Value::array();
    for (const T& v : a) out.push(Codec<T>::get(v));
    return out;
  }
  static void set(std::array<T, N>& o, const Value& v) {
    for (size_t i = 0; i < N; ++i) Codec<T>::set(o[i], v.items()[i]);
  }
};
template <class T>
struct Codec<std::vector<T>> {
  static Shape shape() {
    Shape s = Codec<T>::shape();
    s.length = 0;
    return s;
  }
  static Value get(const std::vector<T>& a) {
    Value out = Value::array();
    for (const T& v : a) out.push(Codec<T>::get(v));
    return out;
  }
  static void set(std::vector<T>& o, const Value& v) {
    o.clear();
    for (const Value& item : v.items()) {
      T one{};
      Codec<T>::set(one, item);
      o.push_back(std::move(one));
    }
  }
};

/// One option of one struct, its C++ type erased: what a visitor sees.
struct Field {
  std::string_view name;
  std::string_view doc;
  std::string_view source;  ///< paper and equation, or ""
  Range range;
  Shape shape;
  std::function<Value()> get;             ///< the present value as a config would write it
  std::function<void(const Value&)> set;  ///< takes what read_scalar made (lists: element by element)
};

/// Base of every visitor. `describe` functions call the three templates; visitors override the hooks.
class Visitor {
 public:
  virtual ~Visitor() = default;

  template <class T>
  void option(std::string_view name, T& field, Range range, std::string_view doc, std::string_view source = {}) {
    on_field({name, doc, source, range, Codec<T>::shape(), [&field] { return Codec<T>::get(field); },
              [&field](const Value& v) { Codec<T>::set(field, v); }});
  }
  template <class T>
  void option(std::string_view name, T& field, std::string_view doc, std::string_view source = {}) {
    option(name, field, any(), doc, source);
  }

  /// A sub-table whose struct has its own describe().
  template <class S>
  void table(std::string_view name, S& section, std::string_view doc) {
    on_table(name, doc, [&section](Visitor& v) { describe(section, v); });
  }

  /// A list of sub-tables ([[name]] in TOML).
  template <class S>
  void tables(std::string_view name, std::vector<S>& sections, std::string_view doc) {
    on_tables(
        name, doc, [&sections](size_t n) { sections.resize(n); },
        [&sections](size_t i, Visitor& v) {
          if (i < sections.size()) return describe(sections[i], v);
          S sample{};
          describe(sample, v);
        },
        sections.size());
  }

  /// A condition between options; checked after all of them are read.
  void check(bool holds, std::string_view what) { on_check(holds, what); }

 protected:
  using Inner = std::function<void(Visitor&)>;
  virtual void on_field(Field field) = 0;
  virtual void on_table(std::string_view name, std::string_view doc, const Inner& inner) = 0;
  virtual void on_tables(std::string_view name, std::string_view doc, const std::function<void(size_t)>& resize,
                         const std::function<void(size_t, Visitor&)>& inner, size_t count) = 0;
  virtual void on_check(bool, std::string_view) {}
};

/// A struct of options.
template <class S>
concept Described = requires(S& s, Visitor& v) {
  describe(s, v);
};

}  // namespace swath::core
