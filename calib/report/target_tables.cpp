// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/target_tables.h"

#include <array>
#include <limits>
#include <string>

#include "report/html.h"

namespace swath::calib {
namespace {

using core::Value;
using report::number_text;
using report::Table;

struct Angle {
  const char *key, *name;
};
constexpr std::array<Angle, 3> angles{{{"roll", "roll"}, {"pitch", "pitch"}, {"heading", "heading"}}};
constexpr const char* none = "–";

/// The value at a path of keys; null where there is none.
const Value* at(const Value& tree, const char* key) { return tree.is_object() ? tree.find(key) : nullptr; }

double number(const Value& tree, const char* key) {
  const Value* v = at(tree, key);
  return v && v->is_number() ? v->as_number() : std::numeric_limits<double>::quiet_NaN();
}

bool holds(const Value& tree, const char* key) {
  const Value* v = at(tree, key);
  return v && v->is_bool() && v->as_bool();
}

std::string lines_text(const Value& reading) {
  std::string out;
  if (const Value* lines = at(reading, "lines"))
    for (const Value& l : lines->items()) out += (out.empty() ? "" : " and ") + std::to_string(l.as_int());
  return out;
}

Table angle_table(const Value& tree) {
  Table t{"target-angles", "Angles from the flat target", {}, {}, {}};
  t.columns = {{"angle", false},       {"present (deg)"}, {"readings' mean (deg)"}, {"sigma (arcsec)"}, {"sigma by scatter (arcsec)"},
               {"tolerance (arcsec)"}, {"readings"},      {"outcome", false}};
  for (const auto& [key, name] : angles) {
    const Value* a = at(tree, key);
    if (!a) continue;
    const bool determined = holds(*a, "determined");
    const Value* readings = at(*a, "readings");
    t.rows.push_back({name, number_text(number(*a, "present_deg"), 5), number_text(number(*a, "mean_deg"), 5),
                      number_text(number(*a, "sigma_arcsec"), 1), number_text(number(*a, "sigma_by_scatter_arcsec"), 1),
                      number_text(number(*a, "tolerance_arcsec"), 1), std::to_string(readings ? readings->items().size() : 0),
                      !determined                     ? "not determined"
                      : holds(*a, "beyond_tolerance") ? "beyond the tolerance: new value"
                                                      : "within the tolerance: present value kept"});
  }
  return t;
}

Table reading_table(const Value& tree) {
  Table t{"target-readings", "Readings of the flat target", {}, {}, {}};
  t.columns = {{"quantity", false}, {"lines", false}, {"value"}, {"unit", false}, {"sigma"}, {"unit of sigma", false}};
  const auto add = [&](const char* name, const Value* part, const char* value, const char* unit, int decimals, const char* sigma,
                       const char* sigma_unit, int sigma_decimals) {
    const Value* readings = part ? at(*part, "readings") : nullptr;
    if (!readings) return;
    for (const Value& r : readings->items())
      t.rows.push_back(
          {name, lines_text(r), number_text(number(r, value), decimals), unit, number_text(number(r, sigma), sigma_decimals), sigma_unit});
  };
  for (const auto& [key, name] : angles) add(name, at(tree, key), "value_deg", "deg", 5, "sigma_arcsec", "arcsec", 1);
  add("range offset", at(tree, "range_offset"), "value_m", "m", 4, "sigma_m", "m", 4);
  return t;
}

Table line_table(const Value& tree) {
  Table t{"target-lines", "The flat target in each line: where it lies from its surveyed or mean place, before and after", {}, {}, {}};
  t.columns = {{"line"},
               {"role", false},
               {"heading (deg)"},
               {"height above (m)"},
               {"scan angle (deg)"},
               {"pulses"},
               {"before: along (m)"},
               {"across (m)"},
               {"up (m)"},
               {"after: along (m)"},
               {"across (m)"},
               {"up (m)"},
               {"sigma along (m)"},
               {"sigma across (m)"},
               {"sigma up (m)"}};
  const Value* lines = at(tree, "lines");
  if (!lines) return t;
  for (const Value& l : lines->items()) {
    const Value *before = at(l, "before"), *after = at(l, "after"), *role = at(l, "role");
    std::vector<std::string> row{std::to_string(l.find("line")->as_int()),    role ? role->as_text() : none,
                                 number_text(number(l, "heading_deg"), 1),    number_text(number(l, "height_m"), 0),
                                 number_text(number(l, "scan_angle_deg"), 2), before ? number_text(number(*before, "pulses"), 0) : none};
    for (const Value* view : {before, after})
      for (const char* key : {"along_m", "across_m", "up_m"}) row.push_back(view ? number_text(number(*view, key), 3) : none);
    for (const char* key : {"along_sigma_m", "across_sigma_m", "up_sigma_m"}) row.push_back(number_text(number(l, key), 3));
    t.rows.push_back(std::move(row));
  }
  return t;
}

}  // namespace

std::vector<Table> target_tables(const Value& tree) {
  std::vector<Table> out;
  for (Table t : {angle_table(tree), line_table(tree), reading_table(tree)})
    if (!t.rows.empty()) out.push_back(std::move(t));
  return out;
}

}  // namespace swath::calib
