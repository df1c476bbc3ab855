// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>

#include "calib/report/report_data.h"
#include "core/picture.h"
#include "report/chart.h"
#include "report/page.h"

namespace swath::calib {

/// Keeps a figure as a file: its name relative to the report, and how it looks. Returns the bytes of its PNG.
using KeepFigure = std::function<std::string(const std::string& file, const core::Picture& picture)>;

/// What the parts of a page are made of, and where they go.
struct PageParts {
  const CalibrationReport& report;
  const KeepFigure& keep;
  report::Page& page;

  /// A chart, kept as figures/NAME.png and set into the page.
  void figure(const std::string& name, const report::Chart& chart, const std::string& caption) const;
};

}  // namespace swath::calib
