// SPDX-License-Identifier: GPL-3.0-or-later
// Buildings under a scanner, ray by ray, for the tests of roofs.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <random>
#include <vector>

#include "quality/roof_returns.h"

namespace swath::quality::test {

/// A body of half spaces n . p <= d, by its outward normals.
struct Body {
  std::vector<Eigen::Vector4d> planes;
  /// Way along the ray to its entry; none (1e300) where it passes.
  double enter(const Eigen::Vector3d& from, const Eigen::Vector3d& ray) const {
    double in = 0.0, out = 1e300;
    for (const Eigen::Vector4d& p : planes) {
      const double along = p.head<3>().dot(ray), gap = p[3] - p.head<3>().dot(from);
      if (along < 0.0) in = std::max(in, gap / along);
      if (along > 0.0) out = std::min(out, gap / along);
      if (along == 0.0 && gap < 0.0) return 1e300;
    }
    return in < out ? in : 1e300;
  }
};

/// A house whose long side points `turn` from east to north; ridge 0: a flat roof.
struct House {
  Eigen::Vector2d middle{0.0, 0.0};
  double half_length = 20.0, half_width = 10.0, turn = 0.4, eaves = 10.0, ridge = 0.0;
  Eigen::Vector2d along() const { return {std::cos(turn), std::sin(turn)}; }
  Eigen::Vector2d across() const { return {-std::sin(turn), std::cos(turn)}; }
  Body body() const {
    Body b;
    for (const double s : {1.0, -1.0})
      for (const auto& [n, half] : {std::pair(along(), half_length), std::pair(across(), half_width)})
        b.planes.emplace_back(s * n.x(), s * n.y(), 0.0, s * n.dot(middle) + half);
    if (ridge == 0.0) {
      b.planes.emplace_back(0.0, 0.0, 1.0, eaves);
      return b;
    }
    for (const double s : {1.0, -1.0}) {
      const Eigen::Vector2d n = s * across() * (ridge - eaves) / half_width;
      b.planes.emplace_back(n.x(), n.y(), 1.0, n.dot(middle) + ridge);
    }
    return b;
  }
  /// The flat roof, or the facet on the side of across().
  RoofTarget target(const std::string& name, double sigma = 0.01, bool clockwise = false) const {
    RoofTarget t{name, {}, sigma};
    const double inner = ridge == 0.0 ? -half_width : 0.0, top = ridge == 0.0 ? eaves : ridge;
    for (const auto& [a, c, z] : {std::tuple(-half_length, inner, top), std::tuple(half_length, inner, top),
                                  std::tuple(half_length, half_width, eaves), std::tuple(-half_length, half_width, eaves)}) {
      const Eigen::Vector2d p = middle + a * along() + c * across();
      t.corners.emplace_back(p.x(), p.y(), z);
    }
    if (clockwise) std::reverse(t.corners.begin(), t.corners.end());
    return t;
  }
};

enum class Scan { random, lines, zigzag, cone };

/// A flight past a scene whose ground is at height 0; the cloud is off by `shift`.
struct Survey {
  Scan scan = Scan::lines;
  double density = 8.0, flying = 600.0, aside = 150.0, course = 0.3;  ///< pulses per m2, m above ground, m to the right of the line, rad
  double beam = 0.04, place = 0.01, range = 0.015;                    ///< m, sigmas: where in the beam a pulse meets, of x and y, of height
  double crowns = 0.0;  ///< share of the pulses farther than 30 m from the middle that meet a crown before the ground
  Eigen::Vector2d shift{0.0, 0.0};
  int line = 1;
};

struct Cloud {
  core::Block block;
  std::vector<Eigen::Vector3d> scanner;
};

/// Adds the pulses that come down within `reach` m of `about`.
inline void fly(const Survey& s, const std::vector<Body>& bodies, const Eigen::Vector2d& about, double reach, unsigned seed, Cloud& to) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> even(0.0, 1.0);
  std::normal_distribution<double> normal(0.0, 1.0);
  const Eigen::Vector2d ahead(std::sin(s.course), std::cos(s.course)), right(ahead.y(), -ahead.x());
  const double gap = 1.0 / std::sqrt(s.density), phase_a = even(random), phase_b = even(random);
  const auto rows = static_cast<int>(2.0 * reach / gap);
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < rows; ++i) {
      double a = (i + phase_a) * gap - reach, b = (j + phase_b) * gap - reach, before = 0.0;
      if (s.scan == Scan::random) a = (2.0 * even(random) - 1.0) * reach, b = (2.0 * even(random) - 1.0) * reach;
      if (s.scan == Scan::zigzag) b += (j % 2 ? 1.0 : -1.0) * gap * (0.5 * a / reach);
      if (s.scan == Scan::cone) before = (j % 2 ? 1.0 : -1.0) * std::tan(0.35) * s.flying;
      const Eigen::Vector2d centre = about + a * right + b * ahead;
      const Eigen::Vector2d nadir = about + b * ahead - s.aside * right - before * ahead;
      const Eigen::Vector3d from(nadir.x(), nadir.y(), s.flying);
      const Eigen::Vector2d foot = centre + s.beam * Eigen::Vector2d(normal(random), normal(random));
      const Eigen::Vector3d ray = Eigen::Vector3d(foot.x(), foot.y(), 0.0) - from,
                            aim = Eigen::Vector3d(centre.x(), centre.y(), 0.0) - from;
      double way = 1.0;
      for (const Body& body : bodies) way = std::min(way, body.enter(from, ray));
      const bool crown = (centre - about).norm() > 30.0 && way == 1.0 && even(random) < s.crowns;
      const double above_ground = 5.0 + 8.0 * even(random);
      for (int number = crown ? 0 : 1; number < 2; ++number) {
        // The record has the beam's middle at the range of what a part of it met.
        const Eigen::Vector3d at = from + (number == 0 ? 1.0 - above_ground / s.flying : way) * aim;
        core::Block& k = to.block;
        k.x.push_back(at.x() + s.shift.x() + s.place * normal(random)), k.y.push_back(at.y() + s.shift.y() + s.place * normal(random));
        k.z.push_back(at.z() + s.range * normal(random));
        k.time.push_back(1e5 * s.line + 0.02 * j + 1e-5 * i), k.strip.push_back(static_cast<std::uint16_t>(s.line));
        k.return_number.push_back(static_cast<std::uint8_t>(crown ? number + 1 : 1)), k.return_count.push_back(crown ? 2 : 1);
        k.flags.push_back(0), k.classification.push_back(1);
        to.scanner.emplace_back(from.x() + s.shift.x(), from.y() + s.shift.y(), from.z());
      }
    }
}

}  // namespace swath::quality::test
