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

namespace {

/// The rows of the next epoch, one of each solution that has it, and its time; empty at the end.
double take_epoch(const std::vector<GnssData>& solutions, std::vector<size_t>& next, std::vector<Candidate>& epoch) {
  epoch.clear();
  double time = std::numeric_limits<double>::infinity();
  for (size_t s = 0; s < solutions.size(); ++s)
    if (next[s] < solutions[s].size()) time = std::min(time, solutions[s].time[next[s]]);
  if (time == std::numeric_limits<double>::infinity()) return time;
  for (size_t s = 0; s < solutions.size(); ++s)
    if (next[s] < solutions[s].size() && solutions[s].time[next[s]] <= time + same_epoch) epoch.push_back({s, next[s]++});
  return time;
}

/// By candidate: those that agree with it, itself included. True where any two disagree.
bool group(const std::vector<GnssData>& solutions, const std::vector<Candidate>& fixed, double sigmas, double time, CombinedGnss& out,
           std::vector<std::vector<size_t>>& groups) {
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
  return disagree;
}

/// The weighted mean of a group in place of the last row.
void average(const std::vector<GnssData>& solutions, const std::vector<Candidate>& fixed, const std::vector<size_t>& of, GnssData& data) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d weighted = Eigen::Vector3d::Zero();
  const Eigen::Vector3d about = solutions[fixed[of[0]].solution].position[fixed[of[0]].row];
  for (const size_t g : of) {
    const GnssData& s = solutions[fixed[g].solution];
    const Eigen::Matrix3d w = s.covariance[fixed[g].row].inverse();
    information += w;
    weighted += w * (s.position[fixed[g].row] - about);
  }
  const Eigen::Matrix3d mean = information.inverse();
  data.position.back() = about + mean * weighted;
  data.covariance.back() = static_cast<double>(of.size()) * mean;
}

/// From the last row to the nearest rival: a fixed solution outside the group whose own group is as large.
Eigen::Vector3d to_rival(const std::vector<GnssData>& solutions, const std::vector<Candidate>& fixed,
                         const std::vector<std::vector<size_t>>& groups, const std::vector<size_t>& of, const GnssData& data) {
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Vector3d spread = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < fixed.size(); ++i) {
    if (std::find(of.begin(), of.end(), i) != of.end() || groups[i].size() < of.size()) continue;
    const Eigen::Vector3d d = solutions[fixed[i].solution].position[fixed[i].row] - data.position.back();
    if (d.norm() < nearest) nearest = d.norm(), spread = d;
  }
  return spread;
}

}  // namespace

CombinedGnss combine_gnss(const std::vector<GnssData>& solutions, double sigmas) {
  CombinedGnss out;
  out.taken.assign(solutions.size(), 0);
  std::vector<size_t> next(solutions.size(), 0);
  std::vector<Candidate> epoch, fixed;
  std::vector<std::vector<size_t>> groups;
  const auto take = [&](const Candidate& c) {
    append(out.data, solutions[c.solution], c.row);
    ++out.taken[c.solution];
  };
  for (;;) {
    const double time = take_epoch(solutions, next, epoch);
    if (epoch.empty()) break;
    fixed.clear();
    for (const Candidate& c : epoch)
      if (solutions[c.solution].quality[c.row] == FixQuality::fixed) fixed.push_back(c);
    if (fixed.size() < 2) {
      take(*std::min_element(epoch.begin(), epoch.end(), [&](const Candidate& a, const Candidate& b) {
        return rank(solutions[a.solution].quality[a.row]) < rank(solutions[b.solution].quality[b.row]);
      }));
      continue;
    }
    const bool disagree = group(solutions, fixed, sigmas, time, out, groups);
    const auto chosen = std::max_element(groups.begin(), groups.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
    take(fixed[static_cast<size_t>(chosen - groups.begin())]);
    if (chosen->size() > 1) {
      average(solutions, fixed, *chosen, out.data);
      ++out.averaged;
    }
    if (!disagree) continue;
    ++out.disagreeing;
    const Eigen::Vector3d spread = to_rival(solutions, fixed, groups, *chosen, out.data);
    out.data.covariance.back() += 0.5 * spread * spread.transpose();
  }
  return out;
}

}  // namespace swath::trajectory
