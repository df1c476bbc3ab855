// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/value.h"

#include <algorithm>
#include <numeric>

namespace swath::core {

const Value* Value::find(std::string_view key) const {
  if (!is_object()) return nullptr;
  for (const auto& [name, value] : members())
    if (name == key) return &value;
  return nullptr;
}

Value* Value::find(std::string_view key) { return const_cast<Value*>(std::as_const(*this).find(key)); }

Value& Value::operator[](std::string_view key) {
  if (is_null()) data_ = Object{};
  if (Value* v = find(key)) return *v;
  return members().emplace_back(std::string(key), Value{}).second;
}

Value& Value::push(Value v) {
  if (is_null()) data_ = Array{};
  return items().emplace_back(std::move(v));
}

std::string_view Value::kind() const {
  static constexpr std::string_view names[] = {"nothing", "boolean", "number", "number", "text", "list", "table"};
  return names[data_.index()];
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = word.size() / 3 + 2;
  for (const std::string& c : candidates) {
    std::vector<size_t> row(c.size() + 1);
    std::iota(row.begin(), row.end(), size_t{0});
    for (size_t i = 0; i < word.size(); ++i) {
      size_t diagonal = row[0];
      row[0] = i + 1;
      for (size_t j = 0; j < c.size(); ++j) {
        const size_t above = row[j + 1];
        row[j + 1] = std::min({above + 1, row[j] + 1, diagonal + (word[i] == c[j] ? 0 : 1)});
        diagonal = above;
      }
    }
    if (row.back() < best_distance) {
      best_distance = row.back();
      best = c;
    }
  }
  return best;
}

}  // namespace swath::core
