// SPDX-License-Identifier: GPL-3.0-or-later
// One part of the calibration page by itself.
#pragma once

#include <string>

#include "calib/report/page.h"

namespace swath::calib {

inline bool holds(const std::string& text, const std::string& what) { return text.find(what) != std::string::npos; }

/// A page that holds what `add` adds to it, and figures of no content.
inline std::string html_of(const CalibrationReport& report, void (*add)(const PageParts&)) {
  report::Page page("part");
  const KeepFigure keep = [](const std::string&, const core::Picture&) { return std::string("png"); };
  add({report, keep, page});
  return page.html();
}

}  // namespace swath::calib
