// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_target.h"

#include "calib/report/agreement.h"
#include "calib/report/tables.h"
#include "calib/report/target_tables.h"
#include "calib/report/verdict.h"
#include "report/html.h"

namespace swath::calib {
namespace {

using report::count_text;
using report::number_text;
using report::Table;
using report::Tone;

std::string yes(bool v) { return v ? "yes" : "no"; }

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
  for (const Table& t : target_tables(parts.report.flat_target)) parts.page.table(t);
}

}  // namespace swath::calib
