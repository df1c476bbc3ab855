// SPDX-License-Identifier: GPL-3.0-or-later
// The one declaration per result, as option.h has one per option. A struct of results has a free function
//
//   template <class V> void describe(const SmrfCounts& r, V& v) {
//     v.result("ground", r.ground, "Returns classified as ground.");
//     v.result("rms_m", r.rms, metres(3).in_summary(), "RMS distance of the ground from the surface.");
//   }
//
// found by argument-dependent lookup, and every visitor (report.json, its JSON Schema, the documentation, the terminal summary) is made
// from it. See result_visitors.h for the visitors.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/config/option.h"
#include "core/config/value.h"

namespace swath::core {

/// Who reads a result: everybody (terminal summary, first page of a report), or those who look into the details.
enum class Audience { summary, detail };

/// What became of the records that a count counts. `none`: a count that is part of another one, or not one of records.
enum class Fate { none, kept, changed, flagged, left_out };
std::string_view name_of(Fate f);

/// A number of records with their fate; otherwise a plain number.
template <Fate F>
class CountOf {
 public:
  constexpr CountOf() = default;
  constexpr CountOf(std::uint64_t n) : n_(n) {}
  constexpr operator std::uint64_t() const { return n_; }
  constexpr CountOf& operator++() { return ++n_, *this; }
  constexpr CountOf& operator+=(std::uint64_t n) { return n_ += n, *this; }

 private:
  std::uint64_t n_ = 0;
};
using Kept = CountOf<Fate::kept>;
using Changed = CountOf<Fate::changed>;
using Flagged = CountOf<Fate::flagged>;
using LeftOut = CountOf<Fate::left_out>;

/// How a result is shown, and to whom. report.json holds every digit; texts round to `decimals` (below 0: four significant digits).
struct Form {
  std::string_view unit{};
  int decimals = -1;
  Audience audience = Audience::detail;
  std::string_view limit{};  ///< key of [run.limits] that judges it
  bool only_if_any = false;  ///< left out of the report where it is 0
  bool absent = false;
  bool or_null = false;  ///< null in the report where it has no value, in place of being left out

  constexpr Form in_summary() const {
    Form f = *this;
    f.audience = Audience::summary;
    return f;
  }
  constexpr Form always() const {
    Form f = *this;
    f.or_null = true;
    return f;
  }
  /// Left out of the report unless `holds`.
  constexpr Form only_if(bool holds) const {
    Form f = *this;
    f.absent = !holds;
    return f;
  }
  constexpr Form limited_by(std::string_view key) const {
    Form f = *this;
    f.limit = key;
    return f;
  }
};
constexpr Form plain(int decimals = -1) { return {{}, decimals}; }
constexpr Form metres(int decimals = 3) { return {"m", decimals}; }
constexpr Form millimetres(int decimals = 1) { return {"mm", decimals}; }
constexpr Form in_degrees(int decimals = 4) { return {"deg", decimals}; }
constexpr Form seconds(int decimals = 3) { return {"s", decimals}; }
constexpr Form percent(int decimals = 1) { return {"%", decimals}; }
/// A share of 1.
constexpr Form share(int decimals = 4) { return {"share", decimals}; }
/// A count that is left out of the report where it is 0.
constexpr Form if_any() { return {{}, -1, Audience::detail, {}, true}; }

/// How a C++ type is a result: its shape, and its value for a report; a null value is left out of the report.
template <class T>
struct ResultCodec {
  static Shape shape() { return Codec<T>::shape(); }
  static Value get(const T& v) {
    if constexpr (std::is_floating_point_v<T>)
      if (!std::isfinite(v)) return {};
    return Codec<T>::get(v);
  }
};
template <Fate F>
struct ResultCodec<CountOf<F>> {
  static Shape shape() { return {Kind::integer}; }
  static Value get(CountOf<F> v) { return std::uint64_t{v}; }
};
template <class T>
struct ResultCodec<std::optional<T>> {
  static Shape shape() {
    Shape s = ResultCodec<T>::shape();
    s.optional = true;
    return s;
  }
  static Value get(const std::optional<T>& v) { return v ? ResultCodec<T>::get(*v) : Value{}; }
};
template <>
struct ResultCodec<std::string_view> {
  static Shape shape() { return {Kind::text}; }
  static Value get(std::string_view v) { return v; }
};
/// A vector as a list, a matrix as a list of its rows. Not finite: null in its place.
template <class S, int R, int C, int O, int MR, int MC>
struct ResultCodec<Eigen::Matrix<S, R, C, O, MR, MC>> {
  static Shape shape() {
    Shape s{Kind::number};
    s.length = C == 1 && R > 0 ? R : 0;
    return s;
  }
  static Value get(const Eigen::Matrix<S, R, C, O, MR, MC>& m) {
    Value out = Value::array();
    for (Eigen::Index r = 0; r < m.rows(); ++r) {
      if constexpr (C == 1) {
        out.push(m(r, 0));
      } else {
        Value& row = out.push(Value::array());
        for (Eigen::Index c = 0; c < m.cols(); ++c) row.push(m(r, c));
      }
    }
    return out;
  }
};

/// Is it a number that was computed and is not finite?
template <class T>
bool is_not_finite(const T& v) {
  if constexpr (std::is_floating_point_v<T>) return !std::isfinite(v);
  return false;
}
template <class T>
bool is_not_finite(const std::optional<T>& v) {
  return v && is_not_finite(*v);
}

template <class T>
constexpr Fate fate_of = Fate::none;
template <Fate F>
constexpr Fate fate_of<CountOf<F>> = F;

/// One result of one struct, its C++ type erased: what a visitor sees.
struct ResultField {
  std::string_view key;
  std::string_view doc;
  Form form;
  Shape shape;
  Fate fate = Fate::none;
  std::function<Value()> get;  ///< null where it is left out
  bool is_unknown = false;     ///< judged by a limit and not finite: null in the report, so that the limit is missed
};

/// Base of every visitor. `describe` functions call the templates; visitors override the hooks.
class ResultVisitor {
 public:
  virtual ~ResultVisitor() = default;

  template <class T>
  void result(std::string_view key, const T& value, Form form, std::string_view doc) {
    on_result({key, doc, form, ResultCodec<T>::shape(), fate_of<T>,
               [&value, form] {
                 if (form.absent) return Value{};
                 Value v = ResultCodec<T>::get(value);
                 if (form.only_if_any && v.is_number() && v.as_number() == 0.0) return Value{};
                 return v;
               },
               !form.limit.empty() && is_not_finite(value)});
  }
  template <class T>
  void result(std::string_view key, const T& value, std::string_view doc) {
    result(key, value, Form{}, doc);
  }

  /// A table of results whose struct has its own describe().
  template <class S>
  void table(std::string_view key, const S& section, std::string_view doc) {
    on_table(key, doc, true, [&section](ResultVisitor& v) { describe(section, v); });
  }
  /// The same, left out of the report where it has no value.
  template <class S>
  void table(std::string_view key, const std::optional<S>& section, std::string_view doc) {
    on_table(key, doc, section.has_value(), [&section](ResultVisitor& v) {
      if (section) return describe(*section, v);
      describe(S{}, v);
    });
  }
  /// What others declare or know: a configuration's own values, the findings of a stage. Left out of the report where it is null.
  void other(std::string_view key, const Value& value, std::string_view doc) { on_other(key, doc, value); }
  /// A list of tables.
  template <class S>
  void tables(std::string_view key, const std::vector<S>& sections, std::string_view doc) {
    tables_if(true, key, sections, doc);
  }
  /// The same, left out of the report unless `holds`.
  template <class S>
  void tables_if(bool holds, std::string_view key, const std::vector<S>& sections, std::string_view doc) {
    on_tables(key, doc, holds ? sections.size() : absent, [&sections](size_t i, ResultVisitor& v) {
      if (i < sections.size()) return describe(sections[i], v);
      describe(S{}, v);
    });
  }
  /// Tables by a name of a fixed list (parameters, checks); names that data bear are results of a table in a list.
  template <class S>
  void named_tables(std::string_view key, const std::vector<std::pair<std::string, S>>& sections, std::string_view doc) {
    std::vector<std::string> names;
    for (const auto& [name, section] : sections) names.push_back(name);
    on_named_tables(key, doc, names, [&sections](size_t i, ResultVisitor& v) {
      if (i < sections.size()) return describe(sections[i].second, v);
      describe(S{}, v);
    });
  }

 protected:
  /// The number of tables of a list that is left out.
  static constexpr size_t absent = std::numeric_limits<size_t>::max();
  using Inner = std::function<void(ResultVisitor&)>;
  /// With an index beyond the last: of an empty sample, for documentation.
  using Each = std::function<void(size_t, ResultVisitor&)>;
  virtual void on_result(ResultField field) = 0;
  virtual void on_table(std::string_view key, std::string_view doc, bool present, const Inner& inner) = 0;
  virtual void on_other(std::string_view, std::string_view, const Value&) {}
  virtual void on_tables(std::string_view key, std::string_view doc, size_t count, const Each& each) = 0;
  virtual void on_named_tables(std::string_view key, std::string_view doc, const std::vector<std::string>& names, const Each& each) = 0;
};

/// A struct of results.
template <class S>
concept Reported = requires(const S& s, ResultVisitor& v) {
  describe(s, v);
};

}  // namespace swath::core
