// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace swath::core {

/// Where a value was written: a file with line and column (from 1), "--set", or nothing (made by the program).
struct Location {
  std::string file;
  int line = 0;
  int column = 0;

  /// "survey.toml:12:8", "--set", or "".
  std::string text() const { return line > 0 ? file + ":" + std::to_string(line) + ":" + std::to_string(column) : file; }
};

/// A tree of values with the places they came from: configs in, reports out. Objects keep their order.
class Value {
 public:
  using Array = std::vector<Value>;
  using Member = std::pair<std::string, Value>;
  using Object = std::vector<Member>;

  Value() = default;
  Value(bool b) : data_(b) {}
  Value(std::int64_t i) : data_(i) {}
  Value(int i) : data_(static_cast<std::int64_t>(i)) {}
  Value(unsigned i) : data_(static_cast<std::int64_t>(i)) {}
  Value(std::uint64_t i) : data_(static_cast<std::int64_t>(i)) {}
  Value(double d) : data_(d) {}
  Value(const char* s) : data_(std::string(s)) {}
  Value(std::string_view s) : data_(std::string(s)) {}
  Value(std::string s) : data_(std::move(s)) {}
  Value(Array a) : data_(std::move(a)) {}
  Value(Object o) : data_(std::move(o)) {}
  static Value array() { return Value(Array{}); }
  static Value object() { return Value(Object{}); }

  bool is_null() const { return std::holds_alternative<std::monostate>(data_); }
  bool is_bool() const { return std::holds_alternative<bool>(data_); }
  bool is_int() const { return std::holds_alternative<std::int64_t>(data_); }
  bool is_number() const { return is_int() || std::holds_alternative<double>(data_); }
  bool is_text() const { return std::holds_alternative<std::string>(data_); }
  bool is_array() const { return std::holds_alternative<Array>(data_); }
  bool is_object() const { return std::holds_alternative<Object>(data_); }

  bool as_bool() const { return std::get<bool>(data_); }
  std::int64_t as_int() const { return std::get<std::int64_t>(data_); }
  double as_number() const { return is_int() ? static_cast<double>(as_int()) : std::get<double>(data_); }
  const std::string& as_text() const { return std::get<std::string>(data_); }
  const Array& items() const { return std::get<Array>(data_); }
  Array& items() { return std::get<Array>(data_); }
  const Object& members() const { return std::get<Object>(data_); }
  Object& members() { return std::get<Object>(data_); }

  /// The member of that name, or nullptr (also where this is no object).
  const Value* find(std::string_view key) const;
  Value* find(std::string_view key);
  /// The member of that name, added (null) at the end where there is none. A null value becomes an object.
  Value& operator[](std::string_view key);
  /// Appends to an array. A null value becomes an array.
  Value& push(Value v);

  /// One word for the kind: "text", "number", "boolean", "table", "list", "nothing".
  std::string_view kind() const;

  Location where;

 private:
  std::variant<std::monostate, bool, std::int64_t, double, std::string, Array, Object> data_;
};

/// The candidate nearest to `word` by edit distance, or "" where none is near (distance over a third of its length + 1).
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace swath::core
