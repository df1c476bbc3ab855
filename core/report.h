// SPDX-License-Identifier: GPL-3.0-or-later
// What algorithms and readers report besides their result: named counts with first examples.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::core {

/// Counts of anomalies and of work done, each with up to `examples_kept` first examples ("record 17: range NaN").
class Tally {
 public:
  static constexpr size_t examples_kept = 3;

  void count(const std::string& what, std::uint64_t n = 1) { entries_[what].n += n; }
  void count(const std::string& what, const std::string& example, std::uint64_t n = 1) {
    Entry& e = entries_[what];
    e.n += n;
    if (e.examples.size() < examples_kept) e.examples.push_back(example);
  }
  std::uint64_t of(const std::string& what) const {
    const auto at = entries_.find(what);
    return at == entries_.end() ? 0 : at->second.n;
  }
  /// Sum of what was left out: entries whose name ends in "left out".
  std::uint64_t left_out() const {
    std::uint64_t n = 0;
    for (const auto& [what, e] : entries_)
      if (what.ends_with("left out")) n += e.n;
    return n;
  }
  /// Adds another tally (of a later batch, strip or tile).
  void add(const Tally& o) {
    for (const auto& [what, e] : o.entries_) {
      Entry& mine = entries_[what];
      mine.n += e.n;
      for (const std::string& x : e.examples)
        if (mine.examples.size() < examples_kept) mine.examples.push_back(x);
    }
  }
  bool empty() const { return entries_.empty(); }
  /// {"what": {"count": n, "examples": [...]}}, sorted by name.
  Value value() const {
    Value out = Value::object();
    for (const auto& [what, e] : entries_) {
      Value& one = out[what];
      one["count"] = e.n;
      if (!e.examples.empty()) {
        one["examples"] = Value::array();
        for (const std::string& x : e.examples) one["examples"].push(x);
      }
    }
    return out;
  }
  static Tally from(const Value& v) {
    Tally t;
    for (const auto& [what, one] : v.members()) {
      Entry& e = t.entries_[what];
      e.n = static_cast<std::uint64_t>(one.find("count")->as_int());
      if (const Value* x = one.find("examples"))
        for (const Value& item : x->items()) e.examples.push_back(item.as_text());
    }
    return t;
  }

 private:
  struct Entry {
    std::uint64_t n = 0;
    std::vector<std::string> examples;
  };
  std::map<std::string, Entry> entries_;
};

}  // namespace swath::core
