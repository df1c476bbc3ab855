// SPDX-License-Identifier: GPL-3.0-or-later
// What algorithms and readers report besides their result: named counts with first examples.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/config/value.h"

namespace swath::core {

/// Records of one kind that a stage found in files, and what became of them: read = kept + left out.
struct RecordCount {
  std::string name;
  std::uint64_t read = 0;
  std::optional<std::uint64_t> kept{}, left_out{};
};

template <class V>
void describe(const RecordCount& r, V& v) {
  v.result("name", r.name, "Kind of the records.");
  v.result("read", r.read, "Records that the files hold.");
  v.result("kept", r.kept, "Those that are handed on; absent where they are read by the stages behind it.");
  v.result("left_out", r.left_out, "The others; under `tally` by reason, in the entries that begin with the kind and end in \"left out\".");
}

/// Records of one file that share a fate: how many, and the times of the first and the last of them, GPS time s.
struct FileTimes {
  std::uint64_t n = 0;
  double first = std::numeric_limits<double>::infinity(), last = -std::numeric_limits<double>::infinity();

  void add(double time) { ++n, first = std::min(first, time), last = std::max(last, time); }
  void add(const FileTimes& o) { n += o.n, first = std::min(first, o.first), last = std::max(last, o.last); }
  bool operator==(const FileTimes&) const = default;
};

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
  /// When records that are counted under `what` were taken, by file.
  void add_times(const std::string& what, const std::string& file, const FileTimes& times) {
    if (times.n > 0) entries_[what].files[file].add(times);
  }
  /// Records of a kind ("IMU records") that a file holds. Those that are left out are counted under names that begin with the kind and end
  /// in "left out".
  void read(const std::string& kind, std::uint64_t n) { records_[kind].read += n; }
  /// Those of them that are handed on.
  void keep(const std::string& kind, std::uint64_t n) {
    std::optional<std::uint64_t>& kept = records_[kind].kept;
    kept = kept.value_or(0) + n;
  }
  std::vector<RecordCount> records() const {
    std::vector<RecordCount> out;
    for (const auto& [kind, r] : records_) {
      out.push_back({kind, r.read, r.kept});
      if (r.kept) out.back().left_out = left_out(kind + " ");
    }
    return out;
  }
  /// The first kind of which records are lost; empty where all are accounted for.
  std::string unbalanced() const {
    for (const RecordCount& r : records())
      if (r.kept && r.read != *r.kept + *r.left_out) return r.name;
    return {};
  }
  std::uint64_t of(const std::string& what) const {
    const auto at = entries_.find(what);
    return at == entries_.end() ? 0 : at->second.n;
  }
  /// Sum of what was left out: entries whose name begins with `kind` and ends in "left out".
  std::uint64_t left_out(const std::string& kind = {}) const {
    std::uint64_t n = 0;
    for (const auto& [what, e] : entries_)
      if (what.starts_with(kind) && what.ends_with("left out")) n += e.n;
    return n;
  }
  /// The counts of one flight line, by which they are broken down in the report.
  void add(const Tally& o, int line) {
    add(o);
    for (const auto& [what, e] : o.entries_) entries_[what].lines[line] += e.n;
  }
  /// Adds another tally (of a later batch, strip or tile).
  void add(const Tally& o) {
    for (const auto& [what, e] : o.entries_) {
      Entry& mine = entries_[what];
      mine.n += e.n;
      for (const auto& [line, n] : e.lines) mine.lines[line] += n;
      for (const auto& [file, times] : e.files) mine.files[file].add(times);
      for (const std::string& x : e.examples)
        if (mine.examples.size() < examples_kept) mine.examples.push_back(x);
    }
    for (const auto& [kind, r] : o.records_) {
      read(kind, r.read);
      if (r.kept) keep(kind, *r.kept);
    }
  }
  bool empty() const { return entries_.empty(); }
  /// {"what": {"count": n, "lines": [{"line": 1, "count": n}, ...], "files": [{"file": "a.las", "count": n, "first_s": t, "last_s": t},
  /// ...], "examples": [...]}}, sorted by name.
  Value value() const {
    Value out = Value::object();
    for (const auto& [what, e] : entries_) {
      Value& one = out[what];
      one["count"] = e.n;
      for (const auto& [line, n] : e.lines) one["lines"].push(Value(Value::Object{{"line", line}, {"count", n}}));
      for (const auto& [file, t] : e.files)
        one["files"].push(Value(Value::Object{{"file", file}, {"count", t.n}, {"first_s", t.first}, {"last_s", t.last}}));
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
      if (const Value* lines = one.find("lines"))
        for (const Value& l : lines->items())
          e.lines[static_cast<int>(l.find("line")->as_int())] = static_cast<std::uint64_t>(l.find("count")->as_int());
      if (const Value* files = one.find("files"))
        for (const Value& f : files->items())
          e.files[f.find("file")->as_text()] = {static_cast<std::uint64_t>(f.find("count")->as_int()), f.find("first_s")->as_number(),
                                                f.find("last_s")->as_number()};
      if (const Value* x = one.find("examples"))
        for (const Value& item : x->items()) e.examples.push_back(item.as_text());
    }
    return t;
  }

 private:
  struct Entry {
    std::uint64_t n = 0;
    std::map<int, std::uint64_t> lines;
    std::map<std::string, FileTimes> files;
    std::vector<std::string> examples;
  };
  struct Records {
    std::uint64_t read = 0;
    std::optional<std::uint64_t> kept{};
  };
  std::map<std::string, Entry> entries_;
  std::map<std::string, Records> records_;
};

}  // namespace swath::core
