// SPDX-License-Identifier: GPL-3.0-or-later
// Whose fault a difference at a check point is: the mark's, a line's, or that of the height system.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "quality/check_marks.h"

namespace swath::quality {

/// A line against the marks that it shows.
struct LineAtMarks {
  int line = 0;
  std::uint64_t marks = 0;
  double difference = 0.0, sigma = 0.0;  ///< m: median of ground less mark; what is to be expected of it
};

template <class V>
void describe(const LineAtMarks& l, V& v) {
  v.result("line", l.line, "Flight line.");
  v.result("marks", l.marks, "Check points that it shows.");
  v.result("difference_m", l.difference, core::metres(), "Ground less check point, median.");
  v.result("sigma_m", l.sigma, core::metres(), "Sigma to be expected of that median.");
}

struct NamedFault {
  std::string code;  ///< "check.heights", "check.line", "check.mark"
  std::string sentence;
};

template <class V>
void describe(const NamedFault& f, V& v) {
  v.result("code", f.code, "Code of the warning.");
  v.result("sentence", f.sentence, "What differs from what, with its figures.");
}

struct MarkFaults {
  std::vector<LineAtMarks> lines;
  double common = 0.0;            ///< m, of all lines; 0 where they do not share one
  std::vector<NamedFault> named;  ///< in the order: heights, lines, marks
};

/// Heights of marks in feet beside metres, or the other way round, are named alone: nothing else can be judged with them.
/// Differences are taken apart: what all lines share, what a line has at all its marks, what a mark shows to all its lines. Named is what
/// lies beyond four sigmas: of the marks, the points, the scatter around the mark and that of the differences themselves.
/// `undulation`: of the geoid above the ellipsoid there, m, NaN where not known; asked where all lines share a difference.
MarkFaults find_faults(const std::vector<CheckMark>& marks, const std::vector<MarkReading>& readings,
                       const std::function<double()>& undulation = {});

}  // namespace swath::quality
