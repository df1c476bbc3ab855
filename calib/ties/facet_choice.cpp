// SPDX-License-Identifier: GPL-3.0-or-later
// Source: greedy choice of observations by the determinant of the information matrix; since what one adds only falls as others are taken
// (it is submodular), gains are evaluated anew only at the head of the queue (Minoux 1978). Deviations: seconds are taken as independent
// of one another, and all returns as equally sharp; neither changes which directions a plane sees.
#include "calib/ties/facet_choice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

// What a second's pose is known by before: about a MEMS IMU and fixes of a centimetre or two.
constexpr double position_sigma = 0.02;                     // m
constexpr double attitude_sigma = 1e-4;                     // rad
constexpr double return_sigma = 0.03, plane_sigma = 0.005;  // m: of one return, and of a plane seen by one line

/// One second of one line.
struct Second {
  Matrix6 covariance = Matrix6::Identity();  // of position and attitude in units of their sigmas
  double planes = 0.0;
};

struct SeenIn {
  size_t second;
  Vector6 by;  // derivative of the distance from the plane by the pose, over the sigma of the distance
};

class Choice {
 public:
  Choice(const std::vector<Facet>& facets, const ScannerAt& scanner_at, const ChoiceOptions& o) : o_(o), seen_(facets.size()) {
    std::map<std::pair<std::uint32_t, std::int64_t>, size_t> number;
    for (size_t k = 0; k < facets.size(); ++k)
      for (const FacetLook& l : facets[k].looks) {
        const double time = 0.5 * (l.first + l.last);
        const std::optional<Vector3d> scanner = scanner_at(time);
        if (!scanner) continue;
        const auto [at, fresh] = number.try_emplace({l.line, static_cast<std::int64_t>(std::floor(time))}, seconds_.size());
        if (fresh) seconds_.emplace_back();
        seen_[k].push_back({at->second, derivative(facets[k], l, *scanner)});
      }
  }

  /// Numbers of those taken.
  std::vector<size_t> take_all() {
    using Entry = std::pair<double, size_t>;
    const auto later = [](const Entry& a, const Entry& b) { return a.first < b.first || (a.first == b.first && a.second > b.second); };
    std::priority_queue<Entry, std::vector<Entry>, decltype(later)> queue(later);
    for (size_t k = 0; k < seen_.size(); ++k) queue.emplace(gain(k), k);
    std::vector<size_t> out;
    while (!queue.empty()) {
      const size_t k = queue.top().second;
      queue.pop();
      const double now = gain(k);
      if (now <= 0.0) continue;  // its seconds have enough
      if (!queue.empty() && now < queue.top().first) {
        queue.emplace(now, k);
        continue;
      }
      take(k);
      out.push_back(k);
    }
    std::sort(out.begin(), out.end());
    return out;
  }

 private:
  Vector6 derivative(const Facet& f, const FacetLook& l, const Vector3d& scanner) const {
    const Vector3d &n = f.normal, turn = (f.centre - scanner).cross(n);
    // The plane itself is known by the other looks alone.
    const double others = std::max<double>(1.0, static_cast<double>(f.looks.size()) - 1.0);
    const double used = std::clamp<double>(l.n, 1.0, o_.returns);
    const double variance = (return_sigma * return_sigma / used + plane_sigma * plane_sigma) * (1.0 + 1.0 / others);
    Vector6 by;
    by << position_sigma * n, attitude_sigma * turn;
    return by / std::sqrt(variance);
  }
  bool is_full(const Second& s) const { return s.planes >= *o_.per_second; }
  double gain(size_t facet) const {
    double sum = 0.0;
    for (const SeenIn& s : seen_[facet]) {
      const Second& second = seconds_[s.second];
      if (!is_full(second)) sum += std::log1p(s.by.dot(second.covariance * s.by));
    }
    return sum;
  }
  void take(size_t facet) {
    for (const SeenIn& s : seen_[facet]) {
      Second& second = seconds_[s.second];
      const Vector6 c = second.covariance * s.by;
      second.covariance -= c * c.transpose() / (1.0 + s.by.dot(c));
      second.planes += 1.0;
    }
  }

  const ChoiceOptions& o_;
  std::vector<Second> seconds_;
  std::vector<std::vector<SeenIn>> seen_;
};

}  // namespace

ScannerAt scanner_of(LocalPoints& points) {
  return [&points](double recorded) -> std::optional<Vector3d> {
    const auto place = points.place_at(recorded);
    return place ? std::optional(place->scanner) : std::nullopt;
  };
}

std::vector<Facet> choose_facets(std::vector<Facet> facets, const ScannerAt& scanner_at, const ChoiceOptions& o, core::Tally& tally) {
  if (!o.per_second) return facets;
  const std::vector<size_t> taken = Choice(facets, scanner_at, o).take_all();
  if (taken.size() < facets.size()) tally.count("facets that others make superfluous", facets.size() - taken.size());
  std::vector<Facet> out;
  for (const size_t k : taken) out.push_back(std::move(facets[k]));
  return out;
}

}  // namespace swath::calib
