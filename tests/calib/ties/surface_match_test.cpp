// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/surface_match.h"

#include <gtest/gtest.h>

#include <optional>

#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double height = 400.0;

/// To and fro, across, and one beside: houses on level ground, or nothing.
struct Survey {
  test::TieWorld world;
  test::Flown flown;
  std::optional<trajectory::Trajectory> trajectory;

  Survey(const Vector3d& boresight_deg, bool houses, const std::vector<test::Track>& tracks, unsigned seed = 1) {
    if (houses) world.houses = test::village(25, 150.0, seed);
    world.prf = 20000.0;
    world.truth.roll = core::degrees(boresight_deg[0]);
    world.truth.pitch = core::degrees(boresight_deg[1]);
    world.truth.heading = core::degrees(boresight_deg[2]);
    constexpr double trajectory_noise = 0.03;  // m
    flown = test::fly(world, tracks, seed, trajectory_noise);
    trajectory.emplace(flown.data);
  }
  SurfaceMatch match(const core::Calibration& start = {}, size_t batch = 40000) const {
    return match_surfaces(flown.stream(batch), world.scanner, start, *trajectory, world.frame);
  }
  Vector3d error(const SurfaceMatch& m) const {
    return Vector3d(m.calibration.roll.value - world.truth.roll.value, m.calibration.pitch.value - world.truth.pitch.value,
                    m.calibration.heading.value - world.truth.heading.value);
  }
};

std::vector<test::Track> four_lines() {
  return {{{0, 0}, height, 0.3, 400},
          {{0, 0}, height, 0.3 + core::pi, 400},
          {{0, 0}, height, 0.3 + core::pi / 2, 400},
          {{90, -30}, height, 0.3, 400}};
}

TEST(SurfaceMatch, HalfADegreeIsFoundInAllAngles) {
  constexpr double good = 0.03 * core::degree;  // 0.2 m at this height
  const Vector3d boresights[] = {{0.5, -0.5, 0.5}, {-0.41, 0.33, -0.48}};
  unsigned seed = 1;
  for (const Vector3d& b : boresights) {
    const Survey s(b, true, four_lines(), seed++);
    const SurfaceMatch m = s.match();
    ASSERT_TRUE(m.determined[0] && m.determined[1] && m.determined[2]);
    EXPECT_FALSE(m.scan_reversed);
    EXPECT_TRUE(m.findings.empty()) << m.findings.front().what;
    EXPECT_LT(s.error(m).cwiseAbs().maxCoeff(), good) << s.error(m).transpose() / core::degree;
    for (int k = 0; k < 3; ++k) EXPECT_LT(std::abs(s.error(m)[k]), 4.0 * m.sigma[k]) << k;
    EXPECT_LT(m.sigma.maxCoeff(), good);
    EXPECT_GT(m.agreement, 0.8);
    EXPECT_NEAR(m.change[0], m.calibration.roll.value, 1e-15);
  }
}

TEST(SurfaceMatch, AGoodStartIsNotMadeWorse) {
  const Survey s({0.2, -0.1, 0.3}, true, four_lines());
  const SurfaceMatch m = s.match(s.world.truth);
  for (int k = 0; k < 3; ++k)
    EXPECT_LT(std::abs(m.change[k]), 3.0 * m.sigma[k]) << "angle " << k << ": the caller can tell that nothing is to be changed";
}

TEST(SurfaceMatch, BatchesDoNotMatter) {
  const Survey s({0.3, 0.2, -0.2}, true, four_lines());
  const SurfaceMatch a = s.match(), b = s.match({}, 3001);
  EXPECT_EQ(a.change, b.change);
  EXPECT_EQ(a.windows.size(), b.windows.size());
}

TEST(SurfaceMatch, LevelGroundTellsRollAlone) {
  const Survey s({0.4, 0.3, -0.3}, false, four_lines());
  const SurfaceMatch m = s.match();
  EXPECT_TRUE(m.determined[0]);
  EXPECT_FALSE(m.determined[1]);
  EXPECT_FALSE(m.determined[2]);
  EXPECT_EQ(m.calibration.pitch.value, 0.0);
  EXPECT_EQ(m.calibration.heading.value, 0.0);
  ASSERT_EQ(m.findings.size(), 2u);
  EXPECT_NE(m.findings[0].what.find("pitch"), std::string::npos);
  EXPECT_NE(m.findings[1].what.find("heading"), std::string::npos);
  // Pitch and heading, left wrong, take roll with them by the aircraft's attitude: the sigma knows.
  EXPECT_LT(std::abs(s.error(m)[0]), 3.0 * m.sigma[0]);
  EXPECT_LT(m.sigma[0], 0.03 * core::degree);
}

TEST(SurfaceMatch, AScanAngleOfTheWrongSignIsNoticed) {
  Survey s({0.1, -0.2, 0.2}, true, four_lines());
  for (auto& [id, shots] : s.flown.lines)
    for (double& a : shots.angle) a = -a;
  const SurfaceMatch m = s.match();
  EXPECT_TRUE(m.scan_reversed);
  ASSERT_EQ(m.findings.size(), 1u);
  EXPECT_TRUE(m.findings[0].refuses);
  EXPECT_EQ(m.change, Vector3d::Zero());
  EXPECT_TRUE(scan_is_reversed(s.flown.stream(), s.world.scanner, {}, *s.trajectory, s.world.frame));
  const Survey good({0.1, -0.2, 0.2}, true, four_lines());
  EXPECT_FALSE(scan_is_reversed(good.flown.stream(), good.world.scanner, {}, *good.trajectory, good.world.frame));
}

TEST(SurfaceMatch, WithoutOverlapThereIsNothing) {
  const Survey s({0.1, 0.1, 0.1}, true, {{{0, 0}, height, 0.3, 300}, {{2000, 0}, height, 0.3, 300}});
  const SurfaceMatch m = s.match();
  ASSERT_EQ(m.findings.size(), 1u);
  EXPECT_TRUE(m.findings[0].refuses);
  EXPECT_NE(m.findings[0].what.find("overlap"), std::string::npos);
  EXPECT_EQ(m.change, Vector3d::Zero());
  EXPECT_FALSE(m.determined[0] || m.determined[1] || m.determined[2]);
}

TEST(SurfaceMatch, AConeFindsItselfAheadAndBehind) {
  Survey s({0.0, 0.0, 0.0}, true, {{{0, 0}, height, 0.3, 100}});
  s.world.scanner.model = core::ScannerModel::conical;
  s.world.truth.roll = core::degrees(-0.3);
  s.world.truth.pitch = core::degrees(0.4);
  s.flown = test::fly(s.world, {{{0, 0}, height, 0.3, 500}}, 2);
  s.trajectory.emplace(s.flown.data);
  const SurfaceMatch m = s.match();
  ASSERT_TRUE(m.determined[0] && m.determined[1]) << "one line, two looks";
  constexpr double good = 0.03 * core::degree;
  EXPECT_LT(std::abs(s.error(m)[1]), good);
}

}  // namespace
}  // namespace swath::calib
