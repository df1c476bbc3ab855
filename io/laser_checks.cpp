// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/laser_checks.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/statistics.h"

namespace swath::io {
namespace {

constexpr size_t looked_at = 20000;                   // returns of a line: some sweeps of the mirror
constexpr double shortest = 1.0, farthest = 15000.0;  // m, median ranges of a survey
constexpr double still = 0.05 * core::degree;         // a mirror that is parked at nadir stays within
constexpr double narrow = 1.2 * core::degree;         // no mirror sweeps so little; 60 deg read as radians stay within
constexpr double filled = 0.75;                       // share of its window that a line's records span
constexpr double margin = 1.0;                        // s that a window may be longer in any case

std::string shown(double value, const char* unit) { return core::format_number(std::round(value * 1000) / 1000) + unit; }

struct Span {
  double first = std::numeric_limits<double>::infinity(), last = -std::numeric_limits<double>::infinity();
};

void check_windows(const Survey& survey, const std::vector<StripInfo>& strips, core::Tally& tally) {
  std::map<int, Span> spans;
  for (const StripInfo& s : strips)
    if (std::isfinite(s.first_time)) {
      Span& span = spans[s.line];
      span.first = std::min(span.first, s.first_time);
      span.last = std::max(span.last, s.last_time);
    }
  for (const LineWindow& w : line_windows(survey)) {
    const auto found = spans.find(w.id);
    const std::string line = "line " + std::to_string(w.id);
    if (found == spans.end()) {
      tally.count("flight lines without a record: is a file missing or cut?", line);
      continue;
    }
    const double length = w.end - w.start, spanned = found->second.last - found->second.first;
    if (spanned < filled * length && length - spanned > margin)
      tally.count("flight lines whose records fill less than three quarters of their time window: cut?",
                  line + ": " + shown(spanned, " s of ") + shown(length, " s"));
  }
}

void check_beams(const Survey& survey, const StripInfo& strip, core::Tally& tally) {
  LaserSource source(survey, strip);
  core::Shots shots;
  if (!source.next(shots, looked_at) || shots.range.empty()) return;
  const LaserFile& file = survey.laser[strip.file];
  const double range = core::median(std::vector<double>(shots.range.begin(), shots.range.end()));
  if (range < shortest || range > farthest)
    tally.count("flight lines whose ranges are those of no survey: check range_unit",
                strip.name(survey) + ": median " + shown(range, " m"));
  const core::ScannerModel model = file.model.value_or(survey.scanner.model);
  if (file.columns.scan_angle.empty() || (model != core::ScannerModel::mirror && model != core::ScannerModel::polygon)) return;
  double widest = 0.0;
  for (const double a : shots.angle) widest = std::max(widest, std::abs(a));
  if (widest > still && widest < narrow)
    tally.count("flight lines whose scan angles are tiny: radians stated as degrees?",
                strip.name(survey) + ": up to " + shown(widest / core::degree, " deg"));
}

}  // namespace

void check_laser(const Survey& survey, const std::vector<StripInfo>& strips, core::Tally& tally) {
  check_windows(survey, strips, tally);
  for (const StripInfo& strip : strips) check_beams(survey, strip, tally);
}

}  // namespace swath::io
