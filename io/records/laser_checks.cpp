// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/statistics.h"
#include "core/time.h"
#include "core/time_gap.h"

namespace swath::io {
namespace {

constexpr size_t looked_at = 20000;                              // returns of a line: some sweeps of the mirror
constexpr double shortest_range = 1.0, longest_range = 15000.0;  // m, median ranges of a survey
constexpr double coarse = 0.1;                                   // m
constexpr size_t enough_ranges = 200, different = 12;
constexpr double still = 0.05 * core::degree;  // a mirror that is parked at nadir stays within
constexpr double narrow = 1.2 * core::degree;  // no mirror sweeps so little; 60 deg read as radians stay within
constexpr double least_span = 0.5;             // s of records, in which each mirror has swept its swath

std::string shown(double value, const char* unit) { return core::format_number(std::round(value * 1000) / 1000) + unit; }

/// Ranges are measured to centimetres: whole numbers of a coarse unit are intensities, counts or numbers of returns.
bool are_whole(const std::vector<double>& ranges, double unit) {
  if (unit < coarse || ranges.size() < enough_ranges) return false;
  std::set<double> seen;
  for (const double r : ranges) {
    const double n = r / unit;
    if (std::abs(n - std::round(n)) > 1e-6 * std::max(1.0, std::abs(n))) return false;
    if (seen.size() < different) seen.insert(std::round(n));
  }
  return seen.size() >= different;
}

void check_beams(const Survey& survey, const StripInfo& strip, core::Tally& tally) {
  LaserSource source(survey, strip);
  core::Shots shots;
  if (!source.next(shots, looked_at) || shots.range.empty()) return;
  const LaserFile& file = survey.laser[strip.file];
  const double range = core::median(std::vector<double>(shots.range.begin(), shots.range.end()));
  if (range < shortest_range || range > longest_range)
    tally.count("flight lines whose ranges are those of no survey: check range_unit",
                strip.name(survey) + ": median " + shown(range, " m"));
  if (!file.columns.range.empty() && are_whole(shots.range, file.range_unit.value))
    tally.count("flight lines whose ranges are whole numbers of coarse units: another column read as columns.range?",
                strip.name(survey) + ": steps of " + shown(file.range_unit.value, " m"));
  const core::ScannerModel model = file.model.value_or(survey.scanner.model);
  if (shots.angle.empty() || file.columns.scan_angle.empty() ||
      (model != core::ScannerModel::mirror && model != core::ScannerModel::polygon))
    return;
  const auto [first, last] = std::minmax_element(shots.time.begin(), shots.time.end());
  if (*last - *first < least_span) return;
  double widest = 0.0;
  for (const double a : shots.angle) widest = std::max(widest, std::abs(a));
  if (widest > still && widest < narrow)
    tally.count("flight lines whose scan angles are tiny: radians stated as degrees?",
                strip.name(survey) + ": up to " + shown(widest / core::degree, " deg"));
}

}  // namespace

void check_laser(const Survey& survey, const std::vector<StripInfo>& strips, core::Tally& tally) {
  for (const StripInfo& strip : strips) check_beams(survey, strip, tally);
}

void hold_common_times(const Survey& survey, const std::vector<StripInfo>& strips, const std::vector<double>& flown) {
  const double latency = survey.calibration.latency.value;
  double first = std::numeric_limits<double>::infinity(), last = -first;
  for (const StripInfo& s : strips) {
    if (!std::isfinite(s.first_time)) continue;
    const double from = s.first_time + latency, to = s.last_time + latency;
    if (from <= flown.back() && to >= flown.front()) return;
    first = std::min(first, from), last = std::max(last, to);
  }
  if (!(first <= last)) return;
  const std::string gap =
      core::usual_time_gap(0.5 * (first + last - flown.front() - flown.back()), last - first + flown.back() - flown.front());
  throw core::Error("the trajectory covers no laser record: records from " + core::utc_text(first) + " to " + core::utc_text(last) +
                        (latency == 0.0 ? "" : " (latency added)") + ", trajectory from " + core::utc_text(flown.front()) + " to " +
                        core::utc_text(flown.back()),
                    survey.name, gap.empty() ? "compare the time scales with `swath info` of the laser and trajectory files" : gap);
}

}  // namespace swath::io
