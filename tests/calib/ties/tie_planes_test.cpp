// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/tie_planes.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double height = 300.0;

std::vector<test::Track> three_lines() {
  return {{{0, 0}, height, 0.3, 240}, {{0, 0}, height, 0.3 + core::pi, 240}, {{20, 10}, height, 0.3 + core::pi / 2, 240}};
}

struct Survey {
  test::TieWorld world;
  test::Flown flown;
  std::optional<trajectory::Trajectory> flight;
  core::Tally tally;

  explicit Survey(test::TieWorld w, const std::vector<test::Track>& tracks = three_lines()) : world(std::move(w)) {
    flown = test::fly(world, tracks, 4);
    flight.emplace(flown.data);
  }
  TieSet find(const TiePlaneOptions& o = {}, const std::vector<SurveyedTarget>& targets = {}, const core::Calibration& c = {},
              size_t batch = 40000) {
    tally = {};
    return find_tie_planes(flown.stream(batch), world.scanner, c, *flight, world.frame, targets, o, tally);
  }
  /// Distance of a place from the nearest true surface of a direction, and that surface's house and plane.
  struct True {
    double distance = 1e9, angle = 0.0;
    const test::House* house = nullptr;
    Vector3d normal = Vector3d::UnitZ();
  };
  True truth(const TiePlane& p) const {
    True best{std::abs(p.centre.z() - world.ground(p.centre.x(), p.centre.y())), std::acos(std::min(p.normal.z(), 1.0)), nullptr,
              Vector3d::UnitZ()};
    for (const test::House& h : world.houses) {
      const bool near =
          std::all_of(h.planes.begin(), h.planes.end(), [&](const auto& q) { return q.template head<3>().dot(p.centre) < q[3] + 0.3; });
      if (!near) continue;
      for (const Eigen::Vector4d& q : h.planes) {
        const True one{std::abs(q.head<3>().dot(p.centre) - q[3]), std::acos(std::min(q.head<3>().dot(p.normal), 1.0)), &h, q.head<3>()};
        if (one.distance + one.angle < best.distance + best.angle) best = one;
      }
    }
    return best;
  }
  Vector3d place(const TieReturns& r, size_t i) const {
    const ShotGeometry g(world.scanner, world.truth);
    return world.frame.local_R_ecef *
           (g.ecef_point(*flight->pose_at(g.time(r.time[i])), {r.angle[i], r.forward[i], r.range[i]}) - world.frame.origin);
  }
};

test::TieWorld village_world() {
  test::TieWorld w;
  w.houses = test::village(14, 80.0, 3);
  w.prf = 30000.0;
  return w;
}

TEST(TiePlanes, FacetsLieOnTrueSurfaces) {
  Survey s(village_world());
  const TieSet set = s.find();
  int roofs = 0;
  constexpr double on_it = 0.03;   // m: noise of 2 cm over tens of returns, and their even spread
  constexpr double along = 0.015;  // rad
  for (const TiePlane& p : set.planes) {
    const Survey::True t = s.truth(p);
    EXPECT_LT(t.distance, on_it);
    EXPECT_LT(t.angle, along);
    EXPECT_LT(p.roughness, 0.03);
    EXPECT_GE(p.half.minCoeff(), 1.5);
    roofs += p.kind == TieKind::roof;
    EXPECT_EQ(p.kind == TieKind::roof, t.house != nullptr && t.normal.z() < 0.99);
  }
  EXPECT_GE(roofs, 14) << "of 28 slopes";
  EXPECT_GT(set.planes.size(), 100u);
  EXPECT_EQ(s.tally.of("planes: roof"), static_cast<std::uint64_t>(roofs));
  ASSERT_EQ(set.lines.size(), 3u);
  EXPECT_EQ(set.lines[2].id, 3);
  // Groups: by plane, then line; two lines or more on each; no more returns than allowed; raw values as recorded.
  std::vector<int> lines(set.planes.size(), 0);
  for (size_t g = 0; g < set.groups.size(); ++g) {
    const TieGroup& x = set.groups[g];
    EXPECT_EQ(x.begin, g == 0 ? 0 : set.groups[g - 1].end);
    EXPECT_GE(x.end - x.begin, 12u);
    EXPECT_LE(x.end - x.begin, 150u);
    if (g > 0) {
      EXPECT_TRUE(x.plane > set.groups[g - 1].plane || (x.plane == set.groups[g - 1].plane && x.line > set.groups[g - 1].line));
    }
    ++lines[x.plane];
  }
  for (const int n : lines) EXPECT_GE(n, 2);
  EXPECT_EQ(set.groups.back().end, set.returns.size());
}

TEST(TiePlanes, HardlyAReturnLiesAtAnEdgeAndNoneBeyond) {
  Survey s(village_world());
  const TieSet set = s.find();
  constexpr double margin = 0.15;      // m: of 0.4, what range noise and cells of occupancy leave
  constexpr double beyond = 3 * 0.02;  // m: of the range noise
  size_t of_roofs = 0, near = 0;
  for (const TieGroup& g : set.groups) {
    const Survey::True t = s.truth(set.planes[g.plane]);
    if (!t.house || set.planes[g.plane].kind != TieKind::roof) continue;
    for (std::uint32_t i = g.begin; i < g.end; ++i) {
      const Vector3d p = s.place(set.returns, i);
      ++of_roofs;
      for (const Eigen::Vector4d& q : t.house->planes)
        if ((q.head<3>() - t.normal).norm() > 1e-9) {
          EXPECT_LT(q.head<3>().dot(p), q[3] + beyond) << "return over the edge of its roof";
          near += q.head<3>().dot(p) > q[3] - margin;
        }
    }
  }
  EXPECT_GT(of_roofs, 1000u);
  EXPECT_LT(near, of_roofs / 50);
}

TEST(TiePlanes, TheSameWhateverTheRunAndTheBatches) {
  Survey s(village_world());
  const TieSet a = s.find(), b = s.find({}, {}, {}, 1777);
  ASSERT_EQ(a.planes.size(), b.planes.size());
  for (size_t k = 0; k < a.planes.size(); ++k) EXPECT_EQ(a.planes[k].centre, b.planes[k].centre);
  EXPECT_EQ(a.returns.time, b.returns.time);
  EXPECT_EQ(a.returns.range, b.returns.range);
}

TEST(TiePlanes, LinesThatMissOneAnotherAreTiedStill) {
  Survey s(village_world());
  core::Calibration off;
  off.roll = core::degrees(0.05), off.pitch = core::degrees(-0.05), off.heading = core::degrees(0.05);  // 0.26 m, 0.5 m between lines
  TiePlaneOptions o;
  o.mismatch = core::Metres(0.3);
  const TieSet set = s.find(o, {}, off);
  int roofs = 0;
  for (const TiePlane& p : set.planes) roofs += p.kind == TieKind::roof;
  EXPECT_GE(roofs, 8);
  EXPECT_GT(set.planes.size(), 80u);
}

TEST(TiePlanes, WoodsTieNothing) {
  test::TieWorld w;
  w.prf = 30000.0;
  w.canopy = 15.0, w.wood_from = -1000.0;
  Survey s(w);
  const TieSet set = s.find();
  EXPECT_TRUE(set.planes.empty());
  EXPECT_EQ(s.tally.of("lines without ties"), 3u);
  EXPECT_TRUE(s.tally.of("no ties: no place that two lines have seen is plane") + s.tally.of("no ties: no plane is good enough") > 0);
}

TEST(TiePlanes, LinesApartTieNothing) {
  test::TieWorld w;
  w.prf = 10000.0;
  Survey s(w, {{{0, 0}, height, 0.3, 100}, {{1000, 0}, height, 0.3, 100}});
  EXPECT_TRUE(s.find().planes.empty());
  EXPECT_GT(s.tally.of("cells refused: one line"), 0u);
  EXPECT_EQ(s.tally.of("no ties: no place that two lines have seen is plane"), 1u);
}

TEST(TiePlanes, TheMostPlanesAreSpreadAndSlopesKept) {
  Survey s(village_world());
  TiePlaneOptions o;
  o.planes = 40;
  const TieSet set = s.find(o);
  EXPECT_LE(set.planes.size(), 40u);
  EXPECT_GT(set.planes.size(), 30u);
  int roofs = 0, quarter[4] = {};
  for (const TiePlane& p : set.planes) {
    roofs += p.kind == TieKind::roof;
    ++quarter[(p.centre.x() > 0) + 2 * (p.centre.y() > 0)];
  }
  EXPECT_GE(roofs, 10);
  for (const int n : quarter) EXPECT_GE(n, 4);
}

TEST(TiePlanes, AConePassesTwiceInOneLine) {
  test::TieWorld w;
  w.scanner.model = core::ScannerModel::conical;
  w.prf = 30000.0;
  Survey s(w, {{{0, 0}, height, 0.3, 400}});
  const TieSet set = s.find();
  ASSERT_FALSE(set.planes.empty());
  for (size_t g = 1; g < set.groups.size(); ++g) {
    if (set.groups[g].plane != set.groups[g - 1].plane) continue;
    EXPECT_GT(set.returns.time[set.groups[g].begin] - set.returns.time[set.groups[g - 1].end - 1], 1.0);
  }
  EXPECT_GE(set.groups.size(), 2 * set.planes.size());
}

SurveyedTarget flat_roof(const Vector3d& shift) {
  SurveyedTarget t;
  t.name = "hangar";
  for (const auto& [u, v] : {std::pair{-20.0, -12.0}, {20.0, -12.0}, {20.0, 12.0}, {-20.0, 12.0}}) {
    t.corners.push_back(Vector3d(u * std::cos(0.3) - v * std::sin(0.3), u * std::sin(0.3) + v * std::cos(0.3), 9.0) + shift);
    t.control.push_back({t.corners.back(), 0.02, "corner"});
    t.centre += t.corners.back() / 4.0;
  }
  return t;
}

TEST(TiePlanes, ASurveyedRoofIsOnePlaneWithItsControlAlsoInAnotherDatum) {
  test::TieWorld w;
  w.houses = {test::gable({0, 0}, 0.3, 20, 12, 0.0, 9.0, 9.0)};
  w.prf = 30000.0;
  for (const Vector3d& shift : {Vector3d(0, 0, 0), Vector3d(0.8, -0.6, 2.5)}) {
    Survey s(w);
    const TieSet set = s.find({}, {flat_roof(shift)});
    ASSERT_FALSE(set.planes.empty());
    const TiePlane& p = set.planes[0];
    EXPECT_EQ(p.kind, TieKind::target);
    EXPECT_EQ(p.name, "hangar");
    ASSERT_EQ(p.control.size(), 4u);
    EXPECT_NEAR(p.centre.z(), 9.0, 0.01) << "the roof is where the returns are";
    EXPECT_NEAR(p.normal.dot(p.control[0].point - p.centre), shift.z(), 0.03) << "the adjustment sees the misfit";
    // The axes of a nearly level plane lie anywhere in it; the sum of squares does not mind.
    EXPECT_NEAR(p.half.norm(), std::hypot(20.0, 12.0), 2.0);
    int others = 0;
    for (size_t k = 1; k < set.planes.size(); ++k)
      others += std::abs(set.planes[k].centre.z() - 9.0) < 0.5 && set.planes[k].centre.head<2>().norm() < 8.0;
    EXPECT_EQ(others, 0) << "its returns are not used twice";
  }
}

TEST(TiePlanes, ALonePointIsAPatchOfGround) {
  test::TieWorld w;
  w.prf = 30000.0;
  w.slope = 0.05;
  Survey s(w);
  SurveyedTarget t;
  t.name = "P7";
  t.is_point = true;
  t.centre = {30.0, -20.0, w.ground(30.0, -20.0) + 0.4};
  t.corners = {t.centre};
  t.control = {{t.centre, 0.03, "P7"}};
  t.sigma_h = 0.4;
  SurveyedTarget far = t;
  far.name = "P8";
  far.centre = far.corners[0] = {5000.0, 0.0, 0.0};
  const TieSet set = s.find({}, {t, far});
  ASSERT_FALSE(set.planes.empty());
  const TiePlane& p = set.planes[0];
  EXPECT_EQ(p.name, "P7");
  EXPECT_EQ(p.kind, TieKind::target);
  EXPECT_NEAR(p.normal.dot(t.centre - p.centre), 0.4, 0.03);
  EXPECT_NEAR(p.control[0].sigma, std::hypot(0.03, 0.4 * w.slope), 0.003) << "on a slope its place counts for its height";
  EXPECT_LT(p.half.maxCoeff(), 4.0);
  EXPECT_EQ(s.tally.of("targets not found"), 1u);
}

}  // namespace
}  // namespace swath::calib
