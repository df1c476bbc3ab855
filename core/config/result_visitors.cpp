// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/result_visitors.h"

#include <cmath>
#include <cstdio>

#include "core/config/shape_schema.h"

namespace swath::core {
namespace {

constexpr size_t sample = std::numeric_limits<size_t>::max();

std::string path_to(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

class Reporter : public ResultVisitor {
 public:
  Value out = Value::object();

 protected:
  void on_result(ResultField f) override {
    if (Value v = f.get(); !v.is_null() || ((f.form.or_null || f.is_unknown) && !f.form.absent)) out[f.key] = std::move(v);
  }
  void on_table(std::string_view key, std::string_view, bool present, const Inner& inner) override {
    if (present) out[key] = reported(inner);
  }
  void on_other(std::string_view key, std::string_view, const Value& value) override {
    if (!value.is_null()) out[key] = value;
  }
  void on_tables(std::string_view key, std::string_view, size_t count, const Each& each) override {
    if (count == absent) return;
    Value list = Value::array();
    for (size_t i = 0; i < count; ++i) list.push(reported([&](ResultVisitor& v) { each(i, v); }));
    out[key] = std::move(list);
  }
  void on_named_tables(std::string_view key, std::string_view, const std::vector<std::string>& names, const Each& each) override {
    Value tables = Value::object();
    for (size_t i = 0; i < names.size(); ++i) tables[names[i]] = reported([&](ResultVisitor& v) { each(i, v); });
    out[key] = std::move(tables);
  }
};

class Counter : public ResultVisitor {
 public:
  explicit Counter(Tally& tally) : tally_(tally) {}

 protected:
  void on_result(ResultField f) override {
    if (const Value v = f.get(); v.is_int()) tally_.count(std::string(f.key), static_cast<std::uint64_t>(v.as_int()));
  }
  void on_table(std::string_view, std::string_view, bool, const Inner&) override {}
  void on_tables(std::string_view, std::string_view, size_t, const Each&) override {}
  void on_named_tables(std::string_view, std::string_view, const std::vector<std::string>&, const Each&) override {}

 private:
  Tally& tally_;
};

class ResultDocumenter : public ResultVisitor {
 public:
  ResultDocumenter(std::string path, std::vector<ResultDoc>& out) : path_(std::move(path)), out_(out) {}

 protected:
  void on_result(ResultField f) override {
    out_.push_back({path_to(path_, f.key), f.shape.text(), f.form, f.fate, std::string(f.doc), false});
  }
  void on_table(std::string_view key, std::string_view doc, bool, const Inner& inner) override {
    add(path_to(path_, key), "table", doc, path_to(path_, key), inner);
  }
  void on_other(std::string_view key, std::string_view doc, const Value&) override {
    out_.push_back({path_to(path_, key), "table", {}, Fate::none, std::string(doc), true});
  }
  void on_tables(std::string_view key, std::string_view doc, size_t, const Each& each) override {
    const std::string path = path_to(path_, key) + "[]";
    add(path, "list of tables", doc, path, [&](ResultVisitor& v) { each(sample, v); });
  }
  void on_named_tables(std::string_view key, std::string_view doc, const std::vector<std::string>&, const Each& each) override {
    add(path_to(path_, key), "tables by name", doc, path_to(path_, key) + ".*", [&](ResultVisitor& v) { each(sample, v); });
  }

 private:
  void add(const std::string& path, std::string shape, std::string_view doc, const std::string& inside, const Inner& inner) {
    out_.push_back({path, std::move(shape), {}, Fate::none, std::string(doc), true});
    ResultDocumenter d(inside, out_);
    inner(d);
  }
  std::string path_;
  std::vector<ResultDoc>& out_;
};

class ResultSchemer : public ResultVisitor {
 public:
  Value out = Value::object();

  ResultSchemer() {
    out["type"] = "object";
    out["properties"] = Value::object();
  }

 protected:
  void on_result(ResultField f) override {
    Value one = shape_schema(f.shape);
    // What is not finite is null: in a list in its place, alone where it is always reported or judged by a limit.
    const bool is_figure = f.shape.kind == Kind::number || f.shape.kind == Kind::quantity;
    if (is_figure && (f.form.or_null || !f.form.limit.empty() || f.shape.length != 1)) {
      one["type"] = Value::array();
      one["type"].push("number");
      one["type"].push("null");
    }
    if (f.shape.length != 1) {
      Value list = Value::object();
      list["type"] = "array";
      if (f.shape.length > 1) list["items"] = std::move(one);
      one = std::move(list);
    }
    std::string text(f.doc);
    if (!f.form.unit.empty()) text += " Unit: " + std::string(f.form.unit) + ".";
    add(f.key, std::move(one), text);
  }
  void on_table(std::string_view key, std::string_view doc, bool, const Inner& inner) override { add(key, result_schema(inner), doc); }
  void on_other(std::string_view key, std::string_view doc, const Value&) override { add(key, Value::object(), doc); }
  void on_tables(std::string_view key, std::string_view doc, size_t, const Each& each) override {
    Value list = Value::object();
    list["type"] = "array";
    list["items"] = result_schema([&](ResultVisitor& v) { each(sample, v); });
    add(key, std::move(list), doc);
  }
  void on_named_tables(std::string_view key, std::string_view doc, const std::vector<std::string>&, const Each& each) override {
    Value tables = Value::object();
    tables["type"] = "object";
    tables["additionalProperties"] = result_schema([&](ResultVisitor& v) { each(sample, v); });
    add(key, std::move(tables), doc);
  }

 private:
  void add(std::string_view key, Value one, std::string_view doc) {
    one["description"] = doc;
    Value& place = out["properties"][key];
    if (place.is_null()) {
      place = std::move(one);
      return;
    }
    Value either = Value::object();  // a reason as text where there is no table
    either["anyOf"].push(std::move(place));
    either["anyOf"].push(std::move(one));
    place = std::move(either);
  }
};

}  // namespace

std::string_view name_of(Fate f) {
  static constexpr std::string_view names[] = {"", "kept", "changed", "flagged", "left out"};
  return names[static_cast<size_t>(f)];
}

Value reported(const DescribeResults& d) {
  Reporter reporter;
  d(reporter);
  return std::move(reporter.out);
}

void count_results(const DescribeResults& d, Tally& tally) {
  Counter counter(tally);
  d(counter);
}

std::vector<ResultDoc> document_results(const DescribeResults& d) {
  std::vector<ResultDoc> out;
  ResultDocumenter documenter("", out);
  d(documenter);
  return out;
}

std::string result_table_markdown(const DescribeResults& d) {
  std::string out = "| key | holds | unit | fate | meaning |\n|---|---|---|---|---|\n";
  for (const ResultDoc& r : document_results(d)) {
    out += "| `" + r.path + "` | " + r.shape + " | " + std::string(r.form.unit) + " | " + std::string(name_of(r.fate)) + " | " + r.doc;
    if (!r.form.limit.empty()) out += " Judged by `run.limits." + std::string(r.form.limit) + "`.";
    out += " |\n";
  }
  return out;
}

Value result_schema(const DescribeResults& d) {
  ResultSchemer schemer;
  d(schemer);
  return std::move(schemer.out);
}

std::string shown(const Value& number, const Form& form) {
  char text[64];
  const bool is_part = form.unit == "share" || form.unit == "%";
  if (number.is_int())
    std::snprintf(text, sizeof text, "%lld", static_cast<long long>(number.as_int()));
  else if (form.decimals < 0)
    std::snprintf(text, sizeof text, "%.4g", number.as_number());
  else if (is_part && number.as_number() != 0.0 && std::abs(number.as_number()) < 5.0 * std::pow(10.0, -form.decimals))
    std::snprintf(text, sizeof text, "%.2g", number.as_number());  // a small share is not none
  else
    std::snprintf(text, sizeof text, "%.*f", form.decimals, number.as_number());
  std::string out = text;
  if (!form.unit.empty() && form.unit != "share") out += " " + std::string(form.unit);
  return out;
}

}  // namespace swath::core
