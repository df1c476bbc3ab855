// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/attitude_displacement.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <array>
#include <cmath>

#include "core/config/units.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double mrad = 1e-3, deg = core::pi / 180.0;
constexpr double formula_tolerance = 1e-9;  // rad: what the references are printed to
constexpr double height = 1200.0;           // m, of the reference flights
constexpr double printed_digit = 0.01e-3;   // rad: the paper's examples have two digits

Vector3d seen(const OpposedDisplacements& d) { return {d.along_nadir, d.across, d.along_side}; }

/// The rotation itself, by Newton's method on the exact geometry (y_computed takes no part). Closed to 1e-13 rad below 0.1 rad.
core::Attitude exact_displacement(const OpposedDisplacements& given) {
  Vector3d angles = Vector3d::Zero();  // of the mounting's error
  const auto attitude = [](const Vector3d& a) { return core::Attitude{a.x(), a.y(), a.z()}; };
  const auto model = [&](const Vector3d& a) { return seen(displacements_of(attitude(a), given.z, given.y)); };
  constexpr int most = 50;
  constexpr double step = 1e-6, closed = 1e-15;  // rad
  for (int i = 0; i < most; ++i) {
    Matrix3d by;
    for (int k = 0; k < 3; ++k)
      by.col(k) = (model(angles + step * Vector3d::Unit(k)) - model(angles - step * Vector3d::Unit(k))) / (2 * step);
    const Vector3d change = by.inverse() * (seen(given) - model(angles));
    angles += change;
    if (change.cwiseAbs().maxCoeff() < closed) break;
  }
  return inverse(attitude(angles));
}

TEST(AttitudeDisplacement, ThePapersExamples) {
  EXPECT_NEAR(pitch_displacement((0.50 + 0.51) / 2, height), 0.42 * mrad, printed_digit);
  EXPECT_NEAR(roll_displacement(-(1.20 + 1.35) / 2, height), 1.06 * mrad, printed_digit);
  EXPECT_NEAR(heading_displacement(-0.40, height, 0.0, 55.0), 7.3 * mrad, 0.05 * mrad);
}

TEST(AttitudeDisplacement, TheExactGeometryIsClosed) {
  constexpr double closed = 1e-12;
  for (const core::Attitude& m : {core::Attitude{9e-3, -8e-3, 7e-3}, core::Attitude{-0.05, 0.04, 0.06}, core::Attitude{0, 0, 0}}) {
    const core::Attitude d = exact_displacement(displacements_of(m, 700.0, 240.0));
    const core::Attitude back = inverse(d);
    EXPECT_NEAR(back.roll, m.roll, closed);
    EXPECT_NEAR(back.pitch, m.pitch, closed);
    EXPECT_NEAR(back.heading, m.heading, closed);
  }
}

TEST(AttitudeDisplacement, IteratedFormulasReachTheExactRotation) {
  // The formulas are applied, the target is seen again with the mounting so far: what is left shrinks until nothing is.
  const Matrix3d truth = core::matrix_of({0.5 * deg, -0.4 * deg, 0.5 * deg});
  Matrix3d mounting = Matrix3d::Identity();
  std::array<double, 4> left{};
  for (double& angle : left) {
    // Points are computed with `mounting`: relative to it the scanner stands wrong by truth * mounting^T.
    const core::Attitude error = core::attitude_of(truth * mounting.transpose());
    const core::Attitude d = small_angle_displacement(displacements_of({error.roll, error.pitch, core::wrap_pi(error.heading)}, 700, 240));
    mounting = core::matrix_of(mounting_of(d)) * mounting;
    angle = core::log_so3(truth * mounting.transpose()).norm();
  }
  EXPECT_LT(left[0], 0.2e-3);
  EXPECT_LT(left[1], 5e-6);
  EXPECT_LT(left[3], 1e-9);
}

double limit(const std::array<double, 3>& shape, double y, SideDistance side, bool of_heading) {
  // Smallest size whose error is above 0.1 mrad, by bisection over the mounting's angles.
  double low = 0.0, high = 0.2;
  for (int i = 0; i < 60; ++i) {
    const double a = 0.5 * (low + high);
    const core::Attitude d = inverse({shape[0] * a, shape[1] * a, shape[2] * a});
    const core::Attitude e = small_angle_error(d, height, y, side);
    const double worst = of_heading ? std::abs(e.heading) : std::max(std::abs(e.roll), std::abs(e.pitch));
    (worst > 0.1 * mrad ? high : low) = a;
  }
  return low / mrad;
}

TEST(AttitudeDisplacement, WhereTheFormulasEnd) {
  // Mounting = -displacement, and signs: the references grow all angles below zero.
  constexpr double near = 0.06;  // mrad: the header rounds
  using enum SideDistance;
  EXPECT_NEAR(limit({-1, 0, 0}, 55, surveyed, false), 84.35, near);
  EXPECT_NEAR(limit({0, -1, 0}, 55, surveyed, false), 66.90, near);
  EXPECT_NEAR(limit({0, 0, -1}, 55, surveyed, true), 66.90, near);
  EXPECT_NEAR(limit({0, 0, -1}, 55, computed, true), 84.35, near);
  EXPECT_NEAR(limit({-1, -1, -1}, 55, surveyed, true), 2.09, near);
  EXPECT_NEAR(limit({-1, -1, -1}, 436, surveyed, true), 5.15, near);
  EXPECT_NEAR(limit({-1, -1, -1}, 55, computed, true), 10.02, near);
  EXPECT_NEAR(limit({-1, -1, -1}, 55, computed, false), 49.85, near);
}

TEST(AttitudeDisplacement, WarnsBeyondThem) {
  EXPECT_EQ(small_angle_warning({1 * mrad, 1 * mrad, 1 * mrad}, height, 55), "");
  EXPECT_EQ(small_angle_warning({3 * mrad, 3 * mrad, 3 * mrad}, height, 55), "");
  const std::string heading = small_angle_warning({3 * mrad, 3 * mrad, 3 * mrad}, height, 55, 1e-4, SideDistance::surveyed);
  EXPECT_NE(heading.find("heading by 0.2"), std::string::npos) << heading;
  EXPECT_EQ(heading.find("pitch"), std::string::npos) << heading;
  const std::string all = small_angle_warning({90 * mrad, 90 * mrad, 90 * mrad}, height, 55);
  EXPECT_NE(all.find("roll"), std::string::npos) << all;
  EXPECT_NE(all.find("pitch"), std::string::npos) << all;
}

TEST(AttitudeDisplacementReference, AllCases) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p004_calibration.json");
  rapidjson::Document doc;
  doc.Parse(test::read_bytes(file).c_str());
  for (const auto& c : doc["cases"].GetArray()) {
    SCOPED_TRACE(c["name"].GetString());
    const auto& e = c["edges"];
    const auto half = [&](const char* key) { return (e[key][0].GetDouble() - e[key][1].GetDouble()) / 2; };
    OpposedDisplacements d;
    d.z = height;
    d.y = 55.0;
    // Flights to the east and to the west: north is left of the first and right of the second.
    d.along_nadir = half("x_edges_E");
    d.across = -half("y_edges_N");
    d.along_side = half("x_edges_side_E");
    d.y_computed = e["y_side_computed"].GetDouble();
    const auto expect = [&](const core::Attitude& a, const char* key) {
      EXPECT_NEAR(a.roll, c[key][0].GetDouble() * mrad, formula_tolerance) << key;
      EXPECT_NEAR(a.pitch, c[key][1].GetDouble() * mrad, formula_tolerance) << key;
      EXPECT_NEAR(a.heading, c[key][2].GetDouble() * mrad, formula_tolerance) << key;
    };
    expect(small_angle_displacement(d, SideDistance::surveyed), "displacement_estimated_mrad");
    expect(small_angle_displacement(d, SideDistance::computed), "displacement_with_computed_y_mrad");
    expect(exact_displacement(d), "displacement_exact_mrad");
    const auto& m = c["mounting_roll_pitch_heading_mrad"];
    const core::Attitude mounting{m[0].GetDouble() * mrad, m[1].GetDouble() * mrad, m[2].GetDouble() * mrad};
    const core::Attitude found = inverse(exact_displacement(d));
    EXPECT_NEAR(found.roll, mounting.roll, formula_tolerance);
    EXPECT_NEAR(found.pitch, mounting.pitch, formula_tolerance);
    EXPECT_NEAR(found.heading, mounting.heading, formula_tolerance);
    const OpposedDisplacements mine = displacements_of(mounting, height, 55.0);
    constexpr double printed = 1e-7;  // m: ten digits of 132 m
    EXPECT_NEAR(mine.along_nadir, d.along_nadir, printed);
    EXPECT_NEAR(mine.across, d.across, printed);
    EXPECT_NEAR(mine.along_side, d.along_side, printed);
    EXPECT_NEAR(mine.y_computed, d.y_computed, printed);
  }
}

TEST(AttitudeDisplacementReference, IterationAndLimits) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p004_calibration.json");
  rapidjson::Document doc;
  doc.Parse(test::read_bytes(file).c_str());
  for (const auto& c : doc["cases"].GetArray()) {
    const auto& m = c["mounting_roll_pitch_heading_mrad"];
    if (std::abs(m[0].GetDouble()) > 10.0) continue;  // beyond, the size of a rotation is a matter of its definition
    SCOPED_TRACE(c["name"].GetString());
    const Matrix3d truth = core::matrix_of({m[0].GetDouble() * mrad, m[1].GetDouble() * mrad, m[2].GetDouble() * mrad});
    Matrix3d mounting = Matrix3d::Identity();
    for (const auto& residual : c["residual_after_iteration_mrad"].GetArray()) {
      // Displacements of the points computed with `mounting`: M v against mounting v.
      const auto beam = [&](double y) {
        const Eigen::Vector2d v = truth.bottomRightCorner<2, 2>().inverse() * Eigen::Vector2d(y, height);
        return Vector3d(0, v.x(), v.y());
      };
      const Vector3d profile(0, 0, height / truth(2, 2)), wall = beam(0), side = beam(55);
      OpposedDisplacements d;
      d.z = height;
      d.y = 55.0;
      d.along_nadir = (mounting * profile - truth * profile).x();
      d.across = (mounting * wall - truth * wall).y();
      d.along_side = (mounting * side - truth * side).x();
      mounting = core::matrix_of(mounting_of(small_angle_displacement(d, SideDistance::surveyed))) * mounting;
      const double expected = residual.GetDouble() * mrad;
      constexpr double relative = 1e-5;  // sizes of rotations differ by their definitions in the third order
      EXPECT_NEAR(core::log_so3(truth * mounting.transpose()).norm(), expected, relative * expected + formula_tolerance);
    }
  }
  const auto& limits = doc["limits_mrad"];
  const struct {
    const char* name;
    std::array<double, 3> shape;
  } shapes[] = {{"roll only", {-1, 0, 0}}, {"pitch only", {0, -1, 0}}, {"heading only", {0, 0, -1}}, {"all equal", {-1, -1, -1}}};
  for (const auto& s : shapes)
    for (const double y : {55.0, 436.0})
      for (const auto& [side, word] : {std::pair{SideDistance::surveyed, "simultaneous"}, std::pair{SideDistance::computed, "yprime"}}) {
        const std::string key = std::string(s.name) + ", y=" + std::to_string(static_cast<int>(y)) + " m, " + word;
        ASSERT_TRUE(limits.HasMember(key.c_str())) << key;
        const auto& l = limits[key.c_str()];
        constexpr double close = 0.01;  // of the limit: the references step through sizes
        if (l["rp>0.1mrad"].IsNumber()) {
          EXPECT_NEAR(limit(s.shape, y, side, false), l["rp>0.1mrad"].GetDouble(), close * l["rp>0.1mrad"].GetDouble()) << key;
        }
        if (l["h>0.1mrad"].IsNumber()) {
          EXPECT_NEAR(limit(s.shape, y, side, true), l["h>0.1mrad"].GetDouble(), close * l["h>0.1mrad"].GetDouble()) << key;
        }
      }
}

}  // namespace
}  // namespace swath::calib
