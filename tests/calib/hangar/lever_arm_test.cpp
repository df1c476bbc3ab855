// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/hangar/lever_arm.h"

#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <cmath>

#include "core/config/units.h"
#include "tests/world/support.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;
constexpr double deg = core::degree;
constexpr double rounding = 1e-12;   // m
constexpr double reference = 1e-9;   // m, the reference's printed digits
constexpr double tenth_mm = 0.5e-4;  // m, the last digit of figures in mm

TEST(LeverArm, SignsInWords) {
  // An antenna above the body, 1 m up: right wing down moves it to the right, nose up moves it back.
  const Vector3d up(0, 0, -1);
  const auto antenna = [&](const core::Attitude& a, const Vector3d& lever) {
    return Vector3d(Vector3d::Zero() - point_from_antenna(Vector3d::Zero(), a, lever));
  };
  EXPECT_GT(antenna({3 * deg, 0, 0}, up).y(), 0.05);
  EXPECT_LT(antenna({0, 3 * deg, 0}, up).x(), -0.05);
  // One ahead of the body: nose up lifts it; heading east puts it east.
  EXPECT_LT(antenna({0, 3 * deg, 0}, {1, 0, 0}).z(), -0.05);
  EXPECT_NEAR(antenna({0, 0, 90 * deg}, {1, 0, 0}).y(), 1, rounding);
  // One to the right: right wing down lowers it.
  EXPECT_GT(antenna({3 * deg, 0, 0}, {0, 1, 0}).z(), 0.05);
}

TEST(LeverArm, AVerticalOneUnderTilt) {
  const double z = 0.883, a = 0.25 * deg;
  EXPECT_LT((vertical_lever_arm(z, 0, 0) - Vector3d(0, 0, z)).norm(), rounding);
  EXPECT_LT((vertical_lever_arm(z, a, 0) - Vector3d(0, -z * std::sin(a), z * std::cos(a))).norm(), rounding);
  EXPECT_LT((vertical_lever_arm(z, 0, a) - Vector3d(z * std::sin(a), 0, z * std::cos(a))).norm(), rounding);
  // omega is a roll, phi a pitch turned over: nose down moves an antenna above forward.
  EXPECT_NEAR(attitude_of_tilt(a, 0).roll, a, rounding);
  EXPECT_NEAR(attitude_of_tilt(0, a).pitch, -a, rounding);
  // A quarter of a degree is 3.85 mm.
  EXPECT_NEAR(tilt_shift({0, 0, -z}, {a, 0, 0}), 0.00385, tenth_mm);
}

TEST(LeverArm, TheSigmaOfATiltedOneIsThatOfItsParts) {
  // By differences: roll and pitch of the tilt, and each component of the arm.
  const Vector3d lever(0.4, -0.2, -1.3);
  const Eigen::Matrix3d arm = Vector3d(0.002, 0.003, 0.004).cwiseAbs2().asDiagonal();
  const core::Attitude tilt{4 * deg, -3 * deg, 0};
  constexpr double sigma = 0.1 * deg, step = 1e-6;
  const TiltedArm t = tilted(lever, arm, tilt, sigma);
  EXPECT_LT((t.end - core::matrix_of(tilt) * lever).norm(), rounding);
  EXPECT_LT((t.shift - (t.end - lever)).norm(), rounding);
  const auto end = [&](double roll, double pitch, const Vector3d& l) { return Vector3d(core::matrix_of({roll, pitch, 0}) * l); };
  Vector3d variance = Vector3d::Zero();
  variance += (sigma * (end(tilt.roll + step, tilt.pitch, lever) - end(tilt.roll - step, tilt.pitch, lever)) / (2 * step)).cwiseAbs2();
  variance += (sigma * (end(tilt.roll, tilt.pitch + step, lever) - end(tilt.roll, tilt.pitch - step, lever)) / (2 * step)).cwiseAbs2();
  for (int k = 0; k < 3; ++k) variance += (std::sqrt(arm(k, k)) * end(tilt.roll, tilt.pitch, Vector3d::Unit(k))).cwiseAbs2();
  EXPECT_LT((t.sigma - variance.cwiseSqrt()).norm(), 1e-9);
  // A vertical arm under an omega: eq 3.
  const Vector3d paper = vertical_lever_arm(1.3, 4 * deg, 0);
  const Vector3d ours = tilted({0, 0, -1.3}, arm, {4 * deg, 0, 0}, 0).end;
  EXPECT_LT((Vector3d(ours.x(), -ours.y(), -ours.z()) - paper).norm(), rounding);
}

TEST(LeverArmReference, EquationThree) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p001_survey.json");
  rapidjson::Document d;
  d.Parse(test::read_bytes(file).c_str());
  const auto& lever = d["lever_arm"];
  for (const auto& e : lever["eq3_examples"].GetArray()) {
    const Vector3d mine = vertical_lever_arm(e["Z"].GetDouble(), e["omega_deg"].GetDouble() * deg, e["phi_deg"].GetDouble() * deg);
    for (rapidjson::SizeType k = 0; k < 3; ++k) EXPECT_NEAR(mine[k], e["dXYZ"][k].GetDouble(), reference);
  }
  // Roof above the perspective centre, focal length, antenna: the printed inputs give 0.853 m, not the printed 0.883 m.
  const double z = lever["Z_roof"].GetDouble() - lever["Z_cp"].GetDouble() + lever["f"].GetDouble() + lever["antenna"].GetDouble();
  EXPECT_NEAR(z, lever["computed"].GetDouble(), reference);
  EXPECT_NEAR(vertical_lever_arm(lever["printed"].GetDouble(), 0.25 * deg, 0).head<2>().norm(), lever["shift_15min_mm"].GetDouble() * 1e-3,
              reference);
}

TEST(LeverArmReference, TableTwo) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p003_sync.json");
  rapidjson::Document d;
  d.Parse(test::read_bytes(file).c_str());
  const auto vector = [](const rapidjson::Value& v) { return Vector3d(v[0].GetDouble(), v[1].GetDouble(), v[2].GetDouble()); };
  const auto& table = d["lever_arm_table2"];
  for (const auto& t : table["tilt"].GetObject()) {
    const Vector3d lever = vector(t.value["vector"]);
    EXPECT_NEAR(lever.norm(), t.value["length"].GetDouble(), reference) << t.name.GetString();
    EXPECT_NEAR(tilt_shift(lever, {0, 3 * deg, 0}), t.value["shift_3deg_pitch"].GetDouble(), reference);
    EXPECT_NEAR(tilt_shift(lever, {3 * deg, 0, 0}), t.value["shift_3deg_roll"].GetDouble(), reference);
    EXPECT_NEAR(vertical_lever_arm(lever.z(), 3 * deg, 0).head<2>().norm(), t.value["vertical_only"].GetDouble(), reference);
  }
  for (const auto& r : table["reduction"].GetArray()) {
    const Vector3d a = vector(r["roll_pitch_heading_deg"]) * deg;
    const Vector3d mine = point_from_antenna(vector(r["antenna_ned"]), {a[0], a[1], a[2]}, vector(r["lever_body_frd"]));
    EXPECT_LT((mine - vector(r["cp_ned"])).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace swath::calib
