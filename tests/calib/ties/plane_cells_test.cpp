// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/plane_cells.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

TEST(PlaneCells, AShapeIsThePlaneOfItsPoints) {
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 0.03);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  const Vector3d normal = Vector3d(0.3, -0.2, 0.8).normalized();
  const auto axes = plane_axes(normal);
  Moments<double> m;
  for (int i = 0; i < 4000; ++i) {
    const Vector3d p = Vector3d(50, -20, 7) + 3.0 * uniform(random) * axes[0] + 1.0 * uniform(random) * axes[1] + noise(random) * normal;
    m.add(p.x(), p.y(), p.z());
  }
  const PlaneShape s = shape_of(m.scatter(), m.n - 1.0);
  EXPECT_LT((s.normal - normal).norm(), 0.003);  // 0.03 / (0.58 sqrt(4000)), three times
  EXPECT_NEAR(s.rms, 0.03, 0.002);
  EXPECT_NEAR(s.wide, 3.0 / std::sqrt(3.0), 0.05);
  EXPECT_NEAR(s.narrow, 1.0 / std::sqrt(3.0), 0.02);
  EXPECT_LT((m.mean() - Vector3d(50, -20, 7)).norm(), 0.15);
}

TEST(PlaneCells, NormalsPointUp) {
  const Eigen::Matrix3d level = Vector3d(1.0, 2.0, 0.0).asDiagonal();
  EXPECT_NEAR(shape_of(level, 10.0).normal.z(), 1.0, 1e-12);
}

TEST(PlaneCells, LooksAreOfOneLineAndOneTimeAndHoldAllReturns) {
  test::TieWorld w;
  w.prf = 8000.0;
  w.scanner.model = core::ScannerModel::conical;
  // The second line comes first in the stream.
  test::Flown flown = test::fly(w, {{{0, 0}, 200, 0.4, 150}, {{0, 0}, 200, 2.0, 150}}, 2);
  std::swap(flown.lines[0], flown.lines[1]);
  const trajectory::Trajectory flight(flown.data);
  LocalPoints points(w.scanner, w.truth, flight, w.frame);
  const PlaneCells cells = plane_cells(flown.stream(1234), points, 3.0);
  ASSERT_EQ(cells.lines.size(), 2u);
  EXPECT_EQ(cells.lines[0].id, 1);
  EXPECT_EQ(cells.lines[0].first, flown.lines[1].second.time.front());
  EXPECT_EQ(cells.lines[1].last, flown.lines[0].second.time.back());
  EXPECT_EQ(cells.returns, flown.lines[0].second.size() + flown.lines[1].second.size());
  std::uint64_t held = 0;
  int twice = 0;
  for (size_t k = 0; k < cells.looks.size(); ++k) {
    const CellLook& l = cells.looks[k];
    held += l.moments.n;
    EXPECT_GE(l.moments.n, 3u);
    if (k == 0 || cells.looks[k - 1].cell != l.cell || cells.looks[k - 1].line != l.line) continue;
    EXPECT_GT(l.first - cells.looks[k - 1].last, new_look);
    ++twice;
  }
  EXPECT_GT(held, cells.returns / 2);  // cells of one or two returns are not held
  EXPECT_GT(twice, 100) << "the cone passes twice";
  // A cell's moments are those of its returns.
  PointColumns p;
  const CellLook& one = cells.looks[cells.looks.size() / 2];
  Vector3d sum = Vector3d::Zero();
  double height2 = 0.0;
  std::uint32_t n = 0;
  for (const auto& [id, shots] : flown.lines) {
    if (id != cells.lines[one.line].id) continue;
    points.run(shots, p);
    for (size_t i = 0; i < shots.size(); ++i) {
      if (cell_of(p.x[i], p.y[i], p.z[i], 3.0) != one.cell || shots.time[i] < one.first || shots.time[i] > one.last) continue;
      const Vector3d at = Vector3d(p.x[i], p.y[i], p.z[i]) - centre_of(one.cell, 3.0);
      sum += at, height2 += at.z() * at.z(), ++n;
    }
  }
  constexpr double single_precision = 1e-4;  // m, m^2 of sums of tens
  ASSERT_EQ(n, one.moments.n);
  EXPECT_LT((sum - one.moments.sum.cast<double>()).norm(), single_precision);
  EXPECT_NEAR(static_cast<double>(one.moments.zz), height2, single_precision);
}

TEST(PlaneCells, TheCellFollowsTheDensity) {
  test::TieWorld w;
  for (const double prf : {4000.0, 40000.0}) {
    w.prf = prf;
    const test::Flown flown = test::fly(w, {{{0, 0}, 200, 0.4, 60}}, 2);
    const trajectory::Trajectory flight(flown.data);
    LocalPoints points(w.scanner, w.truth, flight, w.frame);
    const PlaneCells cells = plane_cells(flown.stream(), points, std::nullopt);
    const double density = prf / (w.speed * 2.0 * 200.0 * std::tan(w.half_angle));
    EXPECT_NEAR(cells.density, density, 0.2 * density);
    EXPECT_NEAR(cells.side, std::clamp(std::sqrt(10.0 / cells.density), 1.5, 5.0), 1e-12);
  }
}

}  // namespace
}  // namespace swath::calib
