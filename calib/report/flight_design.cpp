// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flight_design.h"

#include <cmath>

#include "calib/report/residual_bins.h"
#include "core/geo/frames.h"

namespace swath::calib {

FlightDesign flight_design(const CalibrationReport& report) {
  FlightDesign out;
  const std::vector<ReportedLine>& lines = report.lines;
  for (size_t a = 0; a < lines.size(); ++a) {
    out.lines.push_back({lines[a], planes_of(report.ties, lines[a].id)});
    for (size_t b = a + 1; b < lines.size(); ++b)
      if (const std::uint64_t common = common_planes(report.ties, lines[a].id, lines[b].id); common > 0)
        out.pairs.push_back({{lines[a].id, lines[b].id}, common, std::abs(core::wrap_pi(lines[b].heading - lines[a].heading))});
  }
  for (int k = 0; k <= static_cast<int>(TieKind::target); ++k) {
    PlanesOfKind of_kind;
    for (const TiePlane& p : report.ties.planes) {
      if (p.kind != static_cast<TieKind>(k)) continue;
      ++of_kind.planes;
      of_kind.surveyed += !p.control.empty();
    }
    out.planes.emplace_back(name_of(static_cast<TieKind>(k)), of_kind);
  }
  return out;
}

}  // namespace swath::calib
