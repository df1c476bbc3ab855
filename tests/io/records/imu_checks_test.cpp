// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/imu_checks.h"
#include "io/records/imu_axes.h"

#include <cmath>

#include "core/error.h"
#include "io/records/imu_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using Eigen::Vector3d;

constexpr double g = 9.81, step = 0.01;

/// A minute at 100 Hz with one rate and one specific force.
core::ImuData constant(const Vector3d& rate, const Vector3d& force) {
  core::ImuData out;
  for (int k = 0; k < 6000; ++k) {
    out.time.push_back(1.4e9 + step * (k + 1));
    out.step.push_back(step);
    out.angle.emplace_back(rate * step);
    out.velocity.emplace_back(force * step);
  }
  return out;
}

ImuFile stated(ImuKind kind = ImuKind::rates, AccelerationUnit unit = AccelerationUnit::mps2) {
  ImuFile f;
  f.kind = kind;
  f.acceleration_unit = unit;
  f.angle_unit = AngleUnit::rad;
  return f;
}

std::string refusal(const core::ImuData& imu, const ImuFile& f) {
  core::Tally tally;
  try {
    check_imu(imu, f, step, "a.csv", tally);
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "a.csv");
    return e.text();
  }
  return tally.empty() ? "" : tally.value().members()[0].first;
}

void expect_in(const std::string& text, const std::string& part) { EXPECT_NE(text.find(part), std::string::npos) << text; }

const Vector3d gentle(0.01, 0.005, 0.02), up(0.2, -0.1, -g);

TEST(ImuChecks, ALevelVehiclePasses) { EXPECT_EQ(refusal(constant(gentle, up), stated()), ""); }

TEST(ImuChecks, UnitsOfTheSpecificForce) {
  expect_in(refusal(constant(gentle, up / g), stated()), "with acceleration_unit = \"g\" it would be");
  expect_in(refusal(constant(gentle, up * 9.80665), stated(ImuKind::rates, AccelerationUnit::g)), "with acceleration_unit = \"m/s2\"");
  expect_in(refusal(constant(gentle, up * 1e3), stated(ImuKind::rates, AccelerationUnit::g)), "acceleration_unit = \"mg\"");
  expect_in(refusal(constant(gentle, up * step), stated()), "with kind = \"increments\"");
  expect_in(refusal(constant(gentle, up / step), stated(ImuKind::increments)), "with kind = \"rates\" it");
  expect_in(refusal(constant(gentle, up / 5), stated()), "check kind, acceleration_unit");
  expect_in(refusal(constant(gentle, up * 1.2), stated()), "specific force is not gravity in the median");
}

TEST(ImuChecks, AxesAreFoundByGravityAndTheHintPutsThemRight) {
  // Whatever the sensor's axes are, those of the hint make the check pass.
  for (const Vector3d& force : {Vector3d(0, 0, g), Vector3d(g, 0, 0), Vector3d(-g, 0, 0), Vector3d(0, g, 0), Vector3d(0, -g, 0)}) {
    const std::string text = refusal(constant(gentle, force), stated());
    expect_in(text, "gravity is not along the axis");
    ImuFile right = stated();
    const size_t at = text.find("axes = [");
    ASSERT_NE(at, std::string::npos) << text;
    size_t from = at;
    for (std::string& axis : right.axes) {
      const size_t open = text.find('"', from), close = text.find('"', open + 1);
      axis = text.substr(open + 1, close - open - 1);
      from = close + 1;
    }
    const Eigen::Matrix3d R = body_R_record(right);  // right-handed, or it throws
    EXPECT_EQ(refusal(constant(R * gentle, R * force), right), "") << text;
  }
  ImuFile turned = stated();
  turned.heading = core::degrees(90);
  expect_in(refusal(constant(gentle, {0, g, 0}), turned), "check axes, roll, pitch and heading");
  expect_in(refusal(constant(gentle, g * Vector3d(std::sin(0.5), 0, -std::cos(0.5))), stated()), "not level in the median");
}

TEST(ImuChecks, RatesOfNoVehicle) {
  expect_in(refusal(constant(gentle * 57.3, up), stated()), "angular rates no vehicle has");
  expect_in(refusal(constant(gentle * 15, up), stated()), "implausibly large angular rates: degrees stated as radians?");
  expect_in(refusal(constant(gentle / 57.3, up), stated()), "hardly turn: radians stated as degrees");
}

}  // namespace
}  // namespace swath::io
