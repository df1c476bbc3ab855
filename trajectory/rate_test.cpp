// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/rate_test.h"

#include <cstdio>

#include "core/statistics.h"

namespace swath::trajectory {

namespace {

void add_fix(PointFixes& to, const PointFixes& from, size_t i) {
  to.time.push_back(from.time[i]);
  to.position.push_back(from.position[i]);
  to.covariance.push_back(from.covariance[i]);
}

}  // namespace

RateTest test_rate(const PointFixes& fixes, double rate, const std::vector<LineSpan>& lines, const KinematicOptions& o) {
  const double half_step = 0.5 * core::median_step(fixes.time);
  PointFixes kept, others;
  double due = fixes.time.front();
  for (size_t i = 0; i < fixes.size(); ++i) {
    if (fixes.time[i] < due - half_step) {
      add_fix(others, fixes, i);
      continue;
    }
    add_fix(kept, fixes, i);
    while (due - half_step <= fixes.time[i]) due += 1.0 / rate;
  }
  const PointTrack track = track_of(std::move(kept), lines, o);
  RateTest out;
  out.rate = rate;
  out.leave_one_out = leave_one_out(track, o);
  std::array<std::vector<Difference>, interpolators.size()> differences;
  for (size_t i = 0; i < others.size(); ++i) {
    const FixWindow w = window_at(track.fixes.time, others.time[i], static_cast<size_t>(o.epochs), track.longest_step);
    if (w.reach != Reach::full) continue;
    ++out.withheld;
    const Eigen::Matrix3d own = track.model().white_of(others.covariance[i]);
    for (size_t k = 0; k < interpolators.size(); ++k) {
      const Estimate e = estimate_at(track, w, others.time[i], interpolators[k], o);
      differences[k].push_back({others.position[i] - e.state.position(), e.state.covariance.diagonal().head<3>().cwiseSqrt(),
                                (e.error.topLeftCorner<3, 3>() + own).diagonal().cwiseSqrt()});
    }
  }
  for (size_t k = 0; k < interpolators.size(); ++k) out.at_those[k] = statistics_of(differences[k]);
  return out;
}

std::string table_of(const std::vector<RateTest>& rates) {
  char line[200];
  std::string out = "Rates side by side: sigma of the differences E N H, cm, and rms of difference over sigma\n\n";
  const auto head = [&](const char* what) {
    std::snprintf(line, sizeof line, "%-34s", what);
    out += line;
    for (const RateTest& r : rates) {
      std::snprintf(line, sizeof line, " %40g Hz", r.rate);
      out += line;
    }
    out += "\n";
  };
  const auto rows = [&](const auto& statistics_of_rate) {
    for (const Interpolator i : interpolators) {
      std::snprintf(line, sizeof line, "  %-32s", std::string(title_of(i)).c_str());
      out += line;
      for (const RateTest& r : rates) {
        const DifferenceStatistics& s = statistics_of_rate(r)[static_cast<size_t>(i)];
        out += " " + row_of(s.sigma, 100.0, 1) + " " + row_of(s.ratio, 1.0, 2);
      }
      out += "\n";
    }
  };
  head("left out one at a time");
  rows([](const RateTest& r) -> const MethodStatistics& { return r.leave_one_out.statistics; });
  out += "\n";
  head("at the fixes that were taken away");
  rows([](const RateTest& r) -> const MethodStatistics& { return r.at_those; });
  return out;
}

}  // namespace swath::trajectory
