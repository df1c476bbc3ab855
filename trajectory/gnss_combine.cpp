// SPDX-License-Identifier: GPL-3.0-or-later
// Covariance intersection: Julier and Uhlmann, "A non-divergent estimation algorithm in the presence of unknown correlations", ACC 1997.
// Deviation: equal weights instead of those that minimise the trace; the mean is then that of inverse covariances.
#include "trajectory/gnss_combine.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace swath::trajectory {
namespace {

using core::FixQuality;
using core::GnssData;

constexpr double same_epoch = 1e-3;    // s: receivers set their clocks by whole milliseconds
constexpr double same_instant = 1e-5;  // s: 1 mm at 100 m/s; fixes further apart are not averaged

/// One solution's fix at an epoch.
struct Candidate {
  size_t solution, row;
};

double distance_in_sigmas(const GnssData& a, size_t i, const GnssData& b, size_t j) {
  const Eigen::Vector3d d = a.position[i] - b.position[j];
  const Eigen::Matrix3d c = a.covariance[i] + b.covariance[j];
  return std::sqrt(std::max(0.0, d.dot(c.inverse() * d)));
}

/// What counts first: from fixed down as core::FixQuality lists them; `unknown` last.
int rank(FixQuality q) { return q == FixQuality::unknown ? std::numeric_limits<int>::max() : static_cast<int>(q); }

void append(GnssData& to, const GnssData& from, size_t row) {
  to.time.push_back(from.time[row]);
  to.position.push_back(from.position[row]);
  to.covariance.push_back(from.covariance[row]);
  to.quality.push_back(from.quality[row]);
  to.satellites.push_back(from.satellites[row]);
}

}  // namespace

GnssAccount account_of(const GnssData& fixes, double interval) {
  GnssAccount a;
  a.fixes = fixes.size();
  if (fixes.size() == 0) return a;
  a.first = fixes.time.front();
  a.last = fixes.time.back();
  for (const FixQuality q : fixes.quality) ++a.by_quality[static_cast<size_t>(q)];
  for (size_t i = 1; i < fixes.size(); ++i) {
    const double step = fixes.time[i] - fixes.time[i - 1];
    if (interval > 0 && step > 1.5 * interval) ++a.gaps;
    if (step > a.longest_gap) a.longest_gap = step, a.longest_gap_at = fixes.time[i - 1];
  }
  return a;
}

CombinedGnss combine_gnss(const std::vector<GnssData>& solutions, double sigmas) {
  CombinedGnss out;
  out.taken.assign(solutions.size(), 0);
  std::vector<size_t> next(solutions.size(), 0);
  std::vector<Candidate> epoch, fixed;
  std::vector<std::vector<size_t>> groups;  // by candidate: those that agree with it, itself included
  for (;;) {
    double time = std::numeric_limits<double>::infinity();
    for (size_t s = 0; s < solutions.size(); ++s)
      if (next[s] < solutions[s].size()) time = std::min(time, solutions[s].time[next[s]]);
    if (time == std::numeric_limits<double>::infinity()) break;
    epoch.clear();
    for (size_t s = 0; s < solutions.size(); ++s)
      if (next[s] < solutions[s].size() && solutions[s].time[next[s]] <= time + same_epoch) epoch.push_back({s, next[s]++});

    const Candidate best = *std::min_element(epoch.begin(), epoch.end(), [&](const Candidate& a, const Candidate& b) {
      return rank(solutions[a.solution].quality[a.row]) < rank(solutions[b.solution].quality[b.row]);
    });
    fixed.clear();
    for (const Candidate& c : epoch)
      if (solutions[c.solution].quality[c.row] == FixQuality::fixed) fixed.push_back(c);
    if (fixed.size() < 2) {
      append(out.data, solutions[best.solution], best.row);
      ++out.taken[best.solution];
      continue;
    }

    groups.assign(fixed.size(), {});
    bool disagree = false;
    for (size_t i = 0; i < fixed.size(); ++i)
      for (size_t j = 0; j < fixed.size(); ++j) {
        const GnssData &a = solutions[fixed[i].solution], &b = solutions[fixed[j].solution];
        if (i == j) {
          groups[i].push_back(j);
        } else if (std::abs(a.time[fixed[i].row] - b.time[fixed[j].row]) <= same_instant) {
          if (distance_in_sigmas(a, fixed[i].row, b, fixed[j].row) <= sigmas) {
            groups[i].push_back(j);
          } else {
            disagree = true;
            const double apart = (a.position[fixed[i].row] - b.position[fixed[j].row]).norm();
            if (apart > out.worst_disagreement) out.worst_disagreement = apart, out.worst_at = time;
          }
        }
      }
    size_t chosen = 0;
    for (size_t i = 1; i < groups.size(); ++i)
      if (groups[i].size() > groups[chosen].size()) chosen = i;
    const std::vector<size_t>& group = groups[chosen];

    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
    const Eigen::Vector3d about = solutions[fixed[group[0]].solution].position[fixed[group[0]].row];
    for (const size_t g : group) {
      const GnssData& s = solutions[fixed[g].solution];
      const Eigen::Matrix3d w = s.covariance[fixed[g].row].inverse();
      information += w;
      weighted += w * (s.position[fixed[g].row] - about);
    }
    const Eigen::Matrix3d mean = information.inverse();
    append(out.data, solutions[fixed[chosen].solution], fixed[chosen].row);
    ++out.taken[fixed[chosen].solution];
    if (group.size() > 1) {
      out.data.position.back() = about + mean * weighted;
      out.data.covariance.back() = static_cast<double>(group.size()) * mean;
      ++out.averaged;
    }
    if (!disagree) continue;
    ++out.disagreeing;
    // A rival: a fixed solution outside the group whose own group is as large.
    double nearest = std::numeric_limits<double>::infinity();
    Eigen::Vector3d spread = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < fixed.size(); ++i) {
      if (std::find(group.begin(), group.end(), i) != group.end() || groups[i].size() < group.size()) continue;
      const Eigen::Vector3d d = solutions[fixed[i].solution].position[fixed[i].row] - out.data.position.back();
      if (d.norm() < nearest) nearest = d.norm(), spread = d;
    }
    out.data.covariance.back() += 0.5 * spread * spread.transpose();
  }
  return out;
}

}  // namespace swath::trajectory
