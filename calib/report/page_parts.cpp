// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/page_parts.h"

namespace swath::calib {

void PageParts::figure(const std::string& name, const report::Chart& chart, const std::string& caption) const {
  const std::string file = "figures/" + name + ".png";
  keep(file, report::draw(chart));
  page.figure_svg(report::svg(chart), caption, file);
}

}  // namespace swath::calib
