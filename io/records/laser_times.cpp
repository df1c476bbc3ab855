// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/laser_times.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/config/value.h"
#include "core/statistics.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

constexpr size_t around = 5;                                              // records on either side
constexpr double min_share = 0.01, min_missing = 0.1, usual_times = 4.0;  // of the line; s

}  // namespace

double LaserTimes::seconds(const LaserRecords& r, size_t i) const {
  return r.time[i] * tags_.unit.value + (r.week.empty() ? 0.0 : r.week[i] * core::seconds_per_week);
}

bool LaserTimes::next(LaserRecords& out, std::vector<std::uint8_t>& wild, size_t most) {
  if (!begun_) {
    begun_ = true;
    has_ahead_ = reader_->next(ahead_, most);
  }
  if (!has_ahead_) return false;
  std::swap(out, ahead_);
  has_ahead_ = reader_->next(ahead_, most);
  wild.assign(out.size(), 0);
  std::vector<double> times = before_;
  std::vector<size_t> rows;
  for (size_t i = 0; i < out.size(); ++i)
    if (const double t = seconds(out, i); std::isfinite(t)) times.push_back(t), rows.push_back(i);
  const size_t own_end = times.size();
  for (size_t i = 0; has_ahead_ && i < ahead_.size() && times.size() < own_end + around; ++i)
    if (const double t = seconds(ahead_, i); std::isfinite(t)) times.push_back(t);
  for (const size_t k : wild_times(times, out.week.empty() ? period_of(tags_.scale) : 0.0))
    if (k >= before_.size() && k < own_end) wild[rows[k - before_.size()]] = 1;
  before_.assign(times.begin() + static_cast<std::ptrdiff_t>(own_end > around ? own_end - around : 0),
                 times.begin() + static_cast<std::ptrdiff_t>(own_end));
  return true;
}

void count_cut_lines(const std::vector<LineWindow>& windows, const std::vector<LineSpan>& all, core::Tally& tally) {
  std::map<int, LineSpan> spans;
  for (const LineSpan& s : all) {
    LineSpan& span = spans.try_emplace(s.line, s).first->second;
    span.first = std::min(span.first, s.first);
    span.last = std::max(span.last, s.last);
  }
  std::vector<double> missing;  // at the lines' beginnings and ends
  for (const LineWindow& w : windows) {
    const auto at = spans.find(w.id);
    if (at == spans.end()) {
      tally.count("lines without a record", "line " + std::to_string(w.id) + " from " + core::utc_text(w.start));
      continue;
    }
    missing.push_back(at->second.first - w.start);
    missing.push_back(w.end - at->second.last);
  }
  // Half of the ends at most are cut: the survey's windows may be wider than its records.
  const double usual = missing.empty() ? 0.0 : core::quantile(missing, 0.5 - 0.5 / static_cast<double>(missing.size()));
  for (const LineWindow& w : windows) {
    const auto at = spans.find(w.id);
    if (at == spans.end()) continue;
    const double limit = std::max({min_missing, min_share * (w.end - w.start), usual_times * usual});
    const std::array ends{std::pair{at->second.first - w.start, "begin"}, std::pair{w.end - at->second.last, "end"}};
    for (const auto& [seconds, which] : ends)
      if (seconds > limit)
        tally.count("lines whose records do not reach their stated begin or end: is a file cut?",
                    "line " + std::to_string(w.id) + ": " + core::format_number(std::round(seconds * 1e3) / 1e3) + " s of " +
                        core::format_number(std::round((w.end - w.start) * 1e3) / 1e3) + " s are missing at its " + which);
  }
}

}  // namespace swath::io
