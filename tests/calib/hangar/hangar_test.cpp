// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/hangar.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>

#include "core/error.h"
#include "tests/calib/made_hangar.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using io::HangarRole;

class Hangar : public ::testing::Test {
 protected:
  Hangar() { made_.build(); }
  static bool warned(const HangarResult& r, const std::string& words) {
    for (const std::string& w : r.warnings)
      if (w.find(words) != std::string::npos) return true;
    return false;
  }
  std::string fault(const io::HangarSurvey& h) const {
    try {
      solve_hangar(h, false);
    } catch (const core::Error& e) {
      EXPECT_FALSE(e.hint().empty());
      EXPECT_EQ(e.where(), "hangar.toml");
      return e.what();
    }
    return "no error";
  }
  test::MadeHangar made_;
};

TEST_F(Hangar, WithoutNoiseTheLeverArmsComeOut) {
  made_.noise = 0;
  const HangarResult r = solve_hangar(made_.measure(1), false);
  ASSERT_EQ(r.lever_arms.size(), 3u);
  EXPECT_LT((r.lever_arms[0].value - made_.lever_arm(0, 1)).norm(), 1e-8);
  EXPECT_LT((r.lever_arms[1].value - made_.lever_arm(0, 2)).norm(), 1e-8);
  EXPECT_LT((r.lever_arms[2].value - made_.lever_arm(1, 2)).norm(), 1e-8);
  EXPECT_TRUE(r.warnings.empty()) << r.warnings[0];
  EXPECT_NEAR(r.axes.attitude.heading, made_.attitude.heading, 1e-8);
  const std::string lines = survey_lines(r);
  EXPECT_NE(lines.find("[antenna]\nlever_arm = [\"-0.8500 m\", \"0.2600 m\", \"-1.1950 m\"]\nlever_arm_sigma = \"0.00"), std::string::npos)
      << lines;
  EXPECT_NE(lines.find("[calibration]\nlever_arm_scanner = [\"0.3200 m\", \"-0.0600 m\", \"0.3300 m\"]\n\n[sigma]\nlever_arm = \""),
            std::string::npos)
      << lines;
}

class HangarErrors : public Hangar, public ::testing::WithParamInterface<bool> {};

TEST_P(HangarErrors, AreAsLargeAsTheirSigmas) {
  constexpr int seeds = 200;
  std::array<Vector3d, 3> squares{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  double held = 0;
  const std::array<std::pair<size_t, size_t>, 3> ends{{{0, 1}, {0, 2}, {1, 2}}};
  for (unsigned s = 0; s < seeds; ++s) {
    io::HangarSurvey h = made_.measure(100 + s);
    h.elevation_signs = GetParam();
    const HangarResult r = solve_hangar(h, false);
    for (size_t k = 0; k < 3; ++k)
      squares[k] += ((r.lever_arms[k].value - made_.lever_arm(ends[k].first, ends[k].second)).array().square() /
                     r.lever_arms[k].covariance.diagonal().array())
                        .matrix() /
                    seeds;
    if (s >= 50) continue;
    const HangarResult fixed = solve_hangar(h, true);
    const Vector3d error = fixed.points[0].position - made_.in_hangar(made_.points[0].body);
    held += (error.array().square() / fixed.points[0].covariance.diagonal().array()).mean() / 50;
  }
  for (const Vector3d& one : squares) {
    EXPECT_NEAR(std::sqrt(one.mean()), 1, 0.1);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::sqrt(one[k]), 1, 0.2);  // four sigmas of a rms of 200
  }
  EXPECT_GT(std::sqrt(held), GetParam() ? 1.2 : 2.0);  // stations held: sigmas too small
}

INSTANTIATE_TEST_SUITE_P(WithSignsAndWithout, HangarErrors, ::testing::Bool());

TEST_F(Hangar, WrongStartsAndOneBadSightAreTold) {
  io::HangarSurvey h = made_.measure(5);
  h.elevation_signs = false;
  const Vector3d at = made_.in_hangar(made_.points[0].body);
  h.points[0].start = {core::Metres(at.x()), core::Metres(at.y()), core::Metres(2.4)};
  h.distances[3].distance += core::Metres(0.03);
  h.angles[7].angle += core::degrees(0.05);
  h.angles.erase(h.angles.begin());
  const HangarResult r = solve_hangar(h, false);
  EXPECT_TRUE(warned(r, "point 'imu mark': its start value leads to the mirror image"));
  EXPECT_TRUE(warned(r, "station 'S1': the distance to 'T10' (d3) is off by"));
  EXPECT_TRUE(warned(r, "station 'S1': its distances scatter"));
  EXPECT_TRUE(warned(r, "(a7) is off by"));
  EXPECT_TRUE(warned(r, "is not used: a triangle needs"));
  EXPECT_GT(r.stations[0].factor, 5);
  EXPECT_LT((r.lever_arms[1].value - made_.lever_arm(0, 2)).norm(), 0.05);
}

TEST_F(Hangar, VerticalAnglesThatCountDownwards) {
  made_.noise = 0;
  io::HangarSurvey h = made_.measure(5);
  for (io::HangarVertical& v : h.verticals) v.angle = -v.angle;
  EXPECT_TRUE(warned(solve_hangar(h, false), "the sights at the points scatter"));
  h.elevation_signs = false;
  EXPECT_TRUE(warned(solve_hangar(h, false), "are they positive upwards?"));
}

TEST_F(Hangar, AFlatFieldOfTargetsAsksForAStart) {
  made_.height_half_range = 0;
  made_.build();
  for (Vector3d& s : made_.stations) s.z() += 1.2;  // above the plane of the targets
  io::HangarSurvey h = made_.measure(5);
  EXPECT_NE(fault(h).find("lie in one plane: it fits at"), std::string::npos);
  for (size_t s = 0; s < h.stations.size(); ++s)
    h.stations[s].start = {core::Metres(made_.stations[s].x()), core::Metres(made_.stations[s].y()), core::Metres(4)};
  const HangarResult r = solve_hangar(h, false);
  EXPECT_TRUE(warned(r, "decided by its start value alone"));
  EXPECT_LT((r.lever_arms[1].value - made_.lever_arm(0, 2)).norm(), 0.02);
}

TEST_F(Hangar, StatedCoordinates) {
  io::HangarSurvey h = made_.measure(5);
  const Vector3d roof = made_.in_hangar(made_.points[2].body);
  h.points[2].at = {core::Metres(roof.x()), core::Metres(roof.y()), core::Metres(roof.z())};
  h.points[2].sigma = {core::Metres(0.5), core::Metres(0.5), core::Metres(0.001)};
  h.stations[1].at = {core::Metres(made_.stations[1].x()), core::Metres(made_.stations[1].y()), core::Metres(made_.stations[1].z())};
  h.stations[1].sigma = {core::Metres(0.001), core::Metres(0.001), core::Metres(0.001)};
  h.axes.heading = core::Radians(made_.attitude.heading);
  const HangarResult r = solve_hangar(h, false);
  EXPECT_TRUE(warned(r, "point 'roof' has stated coordinates"));
  EXPECT_TRUE(warned(r, "station 'S2' has stated coordinates"));
  EXPECT_TRUE(warned(r, "the heading is stated"));
  const Vector3d sigma = r.lever_arms[1].covariance.diagonal().cwiseSqrt();
  EXPECT_GT(sigma.x(), 0.4);
  EXPECT_GT(sigma.y(), 0.4);
  EXPECT_LT(sigma.z(), 0.02);
  EXPECT_EQ(r.lever_arms[1].sigma(), std::max(sigma.x(), sigma.y()));
}

TEST_F(Hangar, WhatIsMissingIsNamed) {
  const io::HangarSurvey good = made_.measure(5);
  io::HangarSurvey h = good;
  std::erase_if(h.distances, [](const io::HangarDistance& d) { return d.from == "S3" && d.to != "T3" && d.to != "T6"; });
  EXPECT_NE(fault(h).find("station 'S3' has 2 distances to targets, 3 are needed"), std::string::npos);
  h = good;
  for (io::HangarDistance& d : h.distances)
    if (d.from == "S2") d.distance = d.distance / 0.3048;
  EXPECT_NE(fault(h).find("multiplied by 0.304"), std::string::npos) << fault(h);
  h = good;
  h.points.pop_back();
  EXPECT_NE(fault(h).find("heading of the aircraft in the hangar is not known"), std::string::npos);
  h = good;
  for (io::HangarPoint& p : h.points)
    if (p.role != HangarRole::fore && p.role != HangarRole::aft && p.role != HangarRole::imu) p.role = HangarRole::mark;
  EXPECT_NE(fault(h).find("two of the points imu, scanner and antenna"), std::string::npos);
  h = good;
  std::erase_if(h.angles, [](const io::HangarAngle& a) { return a.to == "roof"; });
  std::erase_if(h.distances, [](const io::HangarDistance& d) { return d.to == "roof"; });
  EXPECT_NE(fault(h).find("the stations that see point 'roof' are fewer than three"), std::string::npos) << fault(h);
  h = good;
  h.points[0].role = HangarRole::mark;
  const HangarResult r = solve_hangar(h, false);
  EXPECT_TRUE(warned(r, "no point has the role imu"));
  EXPECT_TRUE(survey_lines(r).starts_with("# From scanner to antenna"));
}

TEST(HangarTest, ScatterAgainstChiSquare) {
  // 99.9 % points of chi-square by its tables: 10.83 (1), 29.59 (10), 149.4 (100).
  for (const auto& [n, limit] : {std::pair{1, 10.83}, std::pair{10, 29.59}, std::pair{100, 149.4}}) {
    EXPECT_TRUE(scatter_too_large(1.001 * limit / n, n)) << n;
    EXPECT_FALSE(scatter_too_large(0.999 * limit / n, n)) << n;
  }
  EXPECT_FALSE(scatter_too_large(100, 0));
  EXPECT_FALSE(scatter_too_large(std::nan(""), 3));
}

}  // namespace
}  // namespace swath::calib
