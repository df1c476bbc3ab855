// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/option_visitors.h"
#include "core/config/shape_schema.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace swath::core {
namespace {

std::string join(const std::string& path, std::string_view key) { return path.empty() ? std::string(key) : path + "." + std::string(key); }

std::string scalar_text(const Value& v) {
  if (v.is_null()) return "";
  if (v.is_bool()) return v.as_bool() ? "true" : "false";
  if (v.is_int()) return std::to_string(v.as_int());
  if (v.is_number()) return format_number(v.as_number());
  if (v.is_text()) return '"' + v.as_text() + '"';
  std::string out = "[";
  if (v.is_array())
    for (const Value& item : v.items()) out += (out.size() > 1 ? ", " : "") + scalar_text(item);
  return out + "]";
}

/// A bound itself, written in any unit, is within: units are factors, and 400 gon come out a last digit above a turn.
bool is_within(const Range& range, double v) {
  constexpr double rounding = 1e-12;  // of the bound
  const auto is_at = [v](double bound) { return std::isfinite(bound) && std::abs(v - bound) <= rounding * std::abs(bound); };
  return range.holds(v) || is_at(range.highest) || (!range.above_lowest && is_at(range.lowest));
}

class Reader : public Visitor {
 public:
  Reader(const Value& table, std::string path, std::vector<Fault>& faults, const std::vector<std::string>& also_known)
      : table_(table), path_(std::move(path)), faults_(faults), known_(also_known) {}

  void finish(const std::vector<std::string>& failed_checks) {
    if (!table_.is_object()) return;
    for (const auto& [key, value] : table_.members()) {
      if (std::find(known_.begin(), known_.end(), key) != known_.end()) continue;
      const std::string near = nearest(key, known_);
      std::string list;
      for (const std::string& k : known_) list += (list.empty() ? "" : ", ") + k;
      faults_.push_back(
          {value.where, join(path_, key), "unknown key", near.empty() ? "known here: " + list : "did you mean '" + near + "'?"});
      sound_ = false;
    }
    if (!sound_) return;
    for (const std::string& what : failed_checks) faults_.push_back({table_.where, path_, what, ""});
  }

 protected:
  void on_field(Field f) override {
    known_.emplace_back(f.name);
    const Value* given = table_.find(f.name);
    if (!given || given->is_null()) return;
    const auto fault = [&](const Value& v, const std::string& what, std::string hint = {}) {
      faults_.push_back({v.where.text().empty() ? given->where : v.where, join(path_, f.name), what, std::move(hint)});
      sound_ = false;
    };
    const auto scalar = [&](const Value& v) -> std::optional<Value> {
      std::string why;
      auto read = read_scalar(f.shape, v, why);
      if (!read) {
        fault(v, scalar_text(v) + ": " + why);
        return std::nullopt;
      }
      if (read->is_number() && !is_within(f.range, read->as_number())) {
        fault(v, scalar_text(v) + " is out of range, allowed: " + f.range.text(f.shape.dimension));
        return std::nullopt;
      }
      return read;
    };
    if (f.shape.length == 1) {
      if (auto v = scalar(*given)) f.set(*v);
      return;
    }
    if (!given->is_array()) return fault(*given, "expected a list (" + f.shape.text() + "), got " + std::string(given->kind()));
    if (f.shape.length > 1 && given->items().size() != static_cast<size_t>(f.shape.length))
      return fault(*given, "expected " + std::to_string(f.shape.length) + " values, got " + std::to_string(given->items().size()));
    Value list = Value::array();
    bool good = true;
    for (const Value& item : given->items()) {
      if (auto v = scalar(item))
        list.push(std::move(*v));
      else
        good = false;
    }
    if (good) f.set(list);
  }

  void on_table(std::string_view name, std::string_view, const Inner& inner) override {
    known_.emplace_back(name);
    static const Value empty = Value::object();
    const Value* given = table_.find(name);
    if (given && !given->is_object()) {
      faults_.push_back({given->where, join(path_, name), "expected a table, got " + std::string(given->kind()), ""});
      sound_ = false;
      return;
    }
    if (given)
      read_options(inner, *given, join(path_, name), faults_);
    else
      read_options(inner, empty, join(path_, name), faults_);
  }

  void on_tables(std::string_view name, std::string_view, const std::function<void(size_t)>& resize,
                 const std::function<void(size_t, Visitor&)>& inner, size_t) override {
    known_.emplace_back(name);
    const Value* given = table_.find(name);
    if (!given) return;
    if (!given->is_array()) {
      faults_.push_back({given->where, join(path_, name),
                         "expected a list of tables ([[" + std::string(name) + "]]), got " + std::string(given->kind()), ""});
      sound_ = false;
      return;
    }
    resize(given->items().size());
    for (size_t i = 0; i < given->items().size(); ++i) {
      const std::string path = join(path_, name) + "[" + std::to_string(i + 1) + "]";
      const Value& item = given->items()[i];
      if (!item.is_object())
        faults_.push_back({item.where, path, "expected a table, got " + std::string(item.kind()), ""});
      else
        read_options([&](Visitor& v) { inner(i, v); }, item, path, faults_);
    }
  }

 private:
  const Value& table_;
  std::string path_;
  std::vector<Fault>& faults_;
  std::vector<std::string> known_;
  bool sound_ = true;
};

/// Runs the describe function once more, after the values are set, for its checks alone.
class Checker : public Visitor {
 public:
  std::vector<std::string> failed;

 protected:
  void on_field(Field) override {}
  void on_table(std::string_view, std::string_view, const Inner&) override {}
  void on_tables(std::string_view, std::string_view, const std::function<void(size_t)>&, const std::function<void(size_t, Visitor&)>&,
                 size_t) override {}
  void on_check(bool holds, std::string_view what) override {
    if (!holds) failed.emplace_back(what);
  }
};

class Dumper : public Visitor {
 public:
  Value out = Value::object();

 protected:
  void on_field(Field f) override {
    Value v = f.get();
    if (!v.is_null()) out[f.name] = std::move(v);
  }
  void on_table(std::string_view name, std::string_view, const Inner& inner) override { out[name] = effective_values(inner); }
  void on_tables(std::string_view name, std::string_view, const std::function<void(size_t)>&,
                 const std::function<void(size_t, Visitor&)>& inner, size_t count) override {
    Value list = Value::array();
    for (size_t i = 0; i < count; ++i) list.push(effective_values([&](Visitor& v) { inner(i, v); }));
    out[name] = std::move(list);
  }
};

class Documenter : public Visitor {
 public:
  explicit Documenter(std::string path, std::vector<OptionDoc>& out) : path_(std::move(path)), out_(out) {}

 protected:
  void on_field(Field f) override {
    out_.push_back({join(path_, f.name), f.shape.text(), scalar_text(f.get()), f.range.text(f.shape.dimension), std::string(f.doc),
                    std::string(f.source), false});
  }
  void on_table(std::string_view name, std::string_view doc, const Inner& inner) override {
    out_.push_back({join(path_, name), "table", "", "", std::string(doc), "", true});
    Documenter d(join(path_, name), out_);
    inner(d);
  }
  void on_tables(std::string_view name, std::string_view doc, const std::function<void(size_t)>&,
                 const std::function<void(size_t, Visitor&)>& inner, size_t) override {
    out_.push_back({join(path_, name) + "[]", "list of tables", "", "", std::string(doc), "", true});
    Documenter d(join(path_, name) + "[]", out_);
    inner(std::numeric_limits<size_t>::max(), d);
  }

 private:
  std::string path_;
  std::vector<OptionDoc>& out_;
};

class Schemer : public Visitor {
 public:
  Value out = Value::object();

  Schemer() {
    out["type"] = "object";
    out["additionalProperties"] = false;
    out["properties"] = Value::object();
  }

 protected:
  void on_field(Field f) override {
    Value one = shape_schema(f.shape);
    if (f.shape.kind == Kind::quantity) {  // in a config with its unit
      std::string pattern = "^\\s*[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?\\s*(";
      bool first = true;
      for (const Unit& u : units())
        if (u.dimension == f.shape.dimension) {
          pattern += (first ? "" : "|") + std::string(u.name);
          first = false;
        }
      one["type"] = "string";
      one["pattern"] = pattern + ")\\s*$";
    }
    if (f.shape.kind == Kind::integer || f.shape.kind == Kind::number) {
      if (std::isfinite(f.range.lowest)) one[f.range.above_lowest ? "exclusiveMinimum" : "minimum"] = f.range.lowest;
      if (std::isfinite(f.range.highest)) one["maximum"] = f.range.highest;
    }
    if (f.shape.length != 1) {
      Value list = Value::object();
      list["type"] = "array";
      list["items"] = std::move(one);
      if (f.shape.length > 1) {
        list["minItems"] = f.shape.length;
        list["maxItems"] = f.shape.length;
      }
      one = std::move(list);
    }
    std::string text(f.doc);
    const std::string range = f.range.text(f.shape.dimension);
    if (!range.empty()) text += " Allowed: " + range + ".";
    if (!f.source.empty()) text += " [" + std::string(f.source) + "]";
    one["description"] = text;
    Value fallback = f.get();
    if (!fallback.is_null()) one["default"] = std::move(fallback);
    out["properties"][f.name] = std::move(one);
  }
  void on_table(std::string_view name, std::string_view doc, const Inner& inner) override {
    Value one = schema_of(inner);
    one["description"] = doc;
    out["properties"][name] = std::move(one);
  }
  void on_tables(std::string_view name, std::string_view doc, const std::function<void(size_t)>&,
                 const std::function<void(size_t, Visitor&)>& inner, size_t) override {
    Value list = Value::object();
    list["type"] = "array";
    list["description"] = doc;
    list["items"] = schema_of([&](Visitor& v) { inner(std::numeric_limits<size_t>::max(), v); });
    out["properties"][name] = std::move(list);
  }
};

void canonical(const Value& v, std::string& out) {
  if (v.is_object()) {
    out += '{';
    for (const auto& [key, value] : v.members()) {
      out += key + ':';
      canonical(value, out);
      out += ';';
    }
    out += '}';
  } else if (v.is_array()) {
    out += '[';
    for (const Value& item : v.items()) {
      canonical(item, out);
      out += ';';
    }
    out += ']';
  } else {
    out += scalar_text(v);
  }
}

}  // namespace

std::string Fault::text() const {
  std::string out = where.text();
  if (!out.empty()) out += ": ";
  if (!key.empty()) out += key + ": ";
  out += what;
  if (!hint.empty()) out += " (" + hint + ")";
  return out;
}

void read_options(const Describe& d, const Value& table, const std::string& path, std::vector<Fault>& faults,
                  const std::vector<std::string>& also_known) {
  Reader reader(table, path, faults, also_known);
  d(reader);
  Checker checker;
  d(checker);
  reader.finish(checker.failed);
}

void throw_if_any(const std::vector<Fault>& faults) {
  if (faults.empty()) return;
  std::string all;
  for (const Fault& f : faults) all += (all.empty() ? "" : "\n") + f.text();
  if (faults.size() > 1) all = std::to_string(faults.size()) + " faults:\n" + all;
  throw usage_error(all);
}

Value effective_values(const Describe& d) {
  Dumper dumper;
  d(dumper);
  return std::move(dumper.out);
}

std::vector<OptionDoc> document_options(const Describe& d) {
  std::vector<OptionDoc> out;
  Documenter documenter("", out);
  d(documenter);
  return out;
}

std::string option_table_markdown(const Describe& d) {
  const auto cell = [](std::string s) {
    for (size_t at = 0; (at = s.find('|', at)) != std::string::npos; at += 2) s.insert(at, "\\");
    return s;
  };
  std::string out = "| option | holds | default | allowed | what it does | source |\n|---|---|---|---|---|---|\n";
  for (const OptionDoc& o : document_options(d))
    out += "| `" + o.path + "` | " + cell(o.shape) + " | " + (o.fallback.empty() ? "" : "`" + cell(o.fallback) + "`") + " | " + o.range +
           " | " + cell(o.doc) + " | " + cell(o.source) + " |\n";
  return out;
}

std::string option_table_text(const Describe& d) {
  std::string out;
  for (const OptionDoc& o : document_options(d)) {
    out += "  " + o.path + "  (" + o.shape;
    if (!o.fallback.empty()) out += ", default " + o.fallback;
    if (!o.range.empty()) out += ", " + o.range;
    out += ")\n      " + o.doc;
    if (!o.source.empty()) out += " [" + o.source + "]";
    out += "\n";
  }
  return out;
}

Value schema_of(const Describe& d) {
  Schemer schemer;
  d(schemer);
  return std::move(schemer.out);
}

std::uint64_t fnv1a(std::string_view bytes, std::uint64_t seed) {
  for (const char c : bytes) seed = (seed ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return seed;
}

std::string hex(std::uint64_t v) {
  char buf[17];
  std::snprintf(buf, sizeof buf, "%016llx", static_cast<unsigned long long>(v));
  return buf;
}

std::string fingerprint_of(const Describe& d) {
  std::string text;
  canonical(effective_values(d), text);
  return hex(fnv1a(text));
}

}  // namespace swath::core
