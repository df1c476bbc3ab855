// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/calibration/page_target.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "report/html.h"
#include "stages/calibration/tables.h"
#include "stages/calibration/verdict.h"

namespace swath::stages {
namespace {

using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

std::string yes(bool v) { return v ? "yes" : "no"; }

/// Six significant digits.
std::string plain_text(const core::Value& v) {
  if (v.is_text()) return v.as_text();
  if (v.is_bool()) return yes(v.as_bool());
  if (v.is_int()) return (v.as_int() < 0 ? "−" : "") + std::to_string(std::abs(v.as_int()));
  if (!v.is_number() || !std::isfinite(v.as_number())) return "–";
  char text[64];
  const double size = std::abs(v.as_number());
  return (std::signbit(v.as_number()) ? "−" : "") +
         std::string(text, std::to_chars(text, text + sizeof text, size, std::chars_format::general, 6).ptr);
}

bool is_row(const core::Value& v) {
  return v.is_object() && std::none_of(v.members().begin(), v.members().end(),
                                       [](const core::Value::Member& m) { return m.second.is_object() || m.second.is_array(); });
}

class Details {
 public:
  explicit Details(const PageParts& parts) : parts_(parts) {}

  void details(const core::Value& tree, const std::string& name) {
    if (tree.is_array()) {
      if (std::all_of(tree.items().begin(), tree.items().end(), is_row)) {
        if (!tree.items().empty()) detail_table(name, tree);
        return;
      }
      for (size_t k = 0; k < tree.items().size(); ++k) details(tree.items()[k], name + " " + std::to_string(k + 1));
      return;
    }
    if (!tree.is_object()) return;
    core::Value plain = core::Value::array();
    for (const auto& [key, value] : tree.members())
      if (!value.is_object() && !value.is_array()) {
        core::Value row;
        row["figure"] = key;
        row["value"] = plain_text(value);
        plain.push(std::move(row));
      }
    if (!plain.items().empty()) detail_table(name, plain);
    for (const auto& [key, value] : tree.members())
      if (value.is_object() || value.is_array()) details(value, key);
  }

 private:
  /// A list of tables as one table: its columns are all the names that occur.
  void detail_table(const std::string& caption, const core::Value& rows) {
    Table t{"detail-" + std::to_string(++details_), caption, {}, {}, {}};
    std::vector<std::string> names;
    for (const core::Value& row : rows.items())
      for (const auto& [name, cell] : row.members())
        if (std::find(names.begin(), names.end(), name) == names.end()) {
          names.push_back(name);
          t.columns.push_back({name, cell.is_number() || cell.is_null()});
        }
    for (const core::Value& row : rows.items()) {
      std::vector<std::string> cells;
      for (const std::string& name : names) {
        const core::Value* cell = row.find(name);
        cells.push_back(cell ? plain_text(*cell) : std::string());
      }
      t.rows.push_back(std::move(cells));
    }
    parts_.page.table(t);
  }

  const PageParts& parts_;
  int details_ = 0;
};

}  // namespace

void add_target(const PageParts& parts) {
  if (parts.report.readings.empty() && parts.report.flat_target.is_null()) return;
  parts.page.section("Flat target, analysed by itself");
  if (!parts.report.readings.empty()) {
    parts.page.paragraph(
        "The same parameters read from the edges and the plane of one flat target, by another method on the same flight. They agree where "
        "the "
        "difference stays within twice the joint sigma.");
    Table t{"readings", "Flat target beside the adjustment", {}, {}, {}};
    t.columns = {{"parameter", false}, {"unit", false}, {"adjusted"},      {"flat target"}, {"difference"},
                 {"joint sigma"},      {"readings"},    {"agrees", false}, {"from", false}};
    for (const TargetReading& r : parts.report.readings) {
      const calib::ParameterWords& w = words_of(r.parameter);
      const Agreement a = agreement_of(parts.report.adjustment, r);
      const double from = w.unit == "1" ? 1.0 : 0.0, none = calib::not_known;
      const double adjusted = a.known ? parts.report.adjustment.estimates[static_cast<size_t>(r.parameter)].value : none;
      t.rows.push_back({std::string(w.name), std::string(w.sigma_unit), number_text((adjusted - from) / w.sigma_size, 1),
                        number_text((r.value - from) / w.sigma_size, 1), number_text(a.known ? a.difference / w.sigma_size : none, 1),
                        number_text(a.known ? a.joint_sigma / w.sigma_size : none, 1), count_text(r.readings),
                        a.known ? yes(a.agrees) : "–", r.note});
      t.tones.push_back(!a.known || a.agrees ? Tone::plain : Tone::caution);
    }
    parts.page.table(t);
  }
  if (!parts.report.flat_target.is_null()) Details(parts).details(parts.report.flat_target, "Readings");
}

}  // namespace swath::stages
