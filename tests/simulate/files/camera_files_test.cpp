// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/camera_files.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <set>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "io/text/text_table.h"
#include "simulate/files/exposures.h"
#include "simulate/simulate.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Options small_flight() {
  Options o;
  o.output.laser = false;
  o.imu.file = o.gnss.file = false;
  o.events.file = o.camera.file = true;
  o.events.interval = core::Seconds(3.0);
  o.world.scene = Scene::hills;
  o.world.length = core::Metres(500.0), o.world.width = core::Metres(300.0);
  o.flight.lines = 2, o.flight.cross_lines = 0, o.flight.height = core::Metres(400.0);
  o.camera.points = 30, o.camera.check = 3;
  o.noise.noise_free = true;
  return o;
}

TEST(CameraFiles, ImagePointsAreThoseOfTheTruth) {
  const test::TemporaryFolder folder;
  const Options o = small_flight();
  const Made made = run(o, folder.path(), {});
  ASSERT_TRUE(made.images);
  EXPECT_GT(*made.images, 5u);
  std::map<std::string, Vector3d> points, centres;
  std::map<std::string, Matrix3d> ecef_R_body;
  const core::Transform to_ecef(core::Crs(o.crs), core::wgs84_ecef());
  const io::TextTable truth(folder.path() / "truth" / "images.csv"), ground(folder.path() / "truth" / "camera_points.csv"),
      marks(folder.path() / "image_points.csv");
  for (size_t r = 0; r < truth.rows(); ++r) {
    const Vector3d ecef = to_ecef({truth.number(r, 3), truth.number(r, 4), truth.number(r, 5)});
    const core::Geodetic g = core::geodetic_of(ecef);
    centres[truth.text(r, 0)] = ecef;
    ecef_R_body[truth.text(r, 0)] =
        core::ecef_R_ned(g.latitude, g.longitude) *
        core::matrix_of({truth.number(r, 6) * core::degree, truth.number(r, 7) * core::degree, truth.number(r, 8) * core::degree});
  }
  for (size_t r = 0; r < ground.rows(); ++r)
    points[ground.text(r, 0)] = to_ecef({ground.number(r, 1), ground.number(r, 2), ground.number(r, 3)});
  ASSERT_EQ(marks.rows(), *made.image_points);
  // Mount 90 deg: x to the right, the upper edge forward; the boresight about the body's axes.
  Matrix3d mounted;
  mounted << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  const Matrix3d body_R_camera =
      core::matrix_of({o.camera.boresight[0].value, o.camera.boresight[1].value, o.camera.boresight[2].value}) * mounted;
  for (size_t r = 0; r < marks.rows(); ++r) {
    const std::string image = marks.text(r, 0);
    const Vector3d d = (ecef_R_body[image] * body_R_camera).transpose() * (points[marks.text(r, 1)] - centres[image]);
    const auto at = seen_at(o.camera, d);
    ASSERT_TRUE(at);
    EXPECT_NEAR(marks.number(r, 2), at->x() / 0.0068 + 3608.0, 1e-3);  // tables round at 1e-4 pixel, and at 1e-6 m
    EXPECT_NEAR(marks.number(r, 3), 2706.0 - at->y() / 0.0068, 1e-3);
  }
}

TEST(CameraFiles, ControlInTheCornersOfTheFlightIsOnImages) {
  const test::TemporaryFolder folder;
  Options o = small_flight();
  o.flight.direction = core::degrees(37.0);
  run(o, folder.path(), {});
  const io::TextTable control(folder.path() / "block_control.csv"), marks(folder.path() / "image_points.csv");
  std::map<std::string, int> seen;
  for (size_t r = 0; r < marks.rows(); ++r) ++seen[marks.text(r, 1)];
  std::set<std::string> corners;
  for (size_t r = 0; r < control.rows(); ++r) corners.insert(control.text(r, 0));
  for (const char* name : {"control1", "control2", "control3", "control4"}) {
    EXPECT_TRUE(corners.contains(name)) << name;
    EXPECT_GE(seen[name], 2) << name;
  }
}

TEST(CameraFiles, StationsHaveTheirShiftAndDrift) {
  const test::TemporaryFolder folder;
  Options o = small_flight();
  o.camera.shift = o.camera.drift = core::Metres(1.0);
  run(o, folder.path(), {});
  const io::TextTable given(folder.path() / "images.csv"), truth(folder.path() / "truth" / "images.csv"),
      drift(folder.path() / "truth" / "drift.csv");
  ASSERT_EQ(drift.rows(), 2u);
  // Up: the antenna lies above the camera by the lever arms, less what tilts make of them.
  const double above = -(o.mounting.lever_arm_antenna[2].value - o.camera.lever_arm[2].value);
  std::map<std::string, std::pair<double, double>> span;
  for (size_t r = 0; r < given.rows(); ++r) {
    auto& s = span.try_emplace(given.text(r, 1), given.number(r, 2), given.number(r, 2)).first->second;
    s.second = given.number(r, 2);
  }
  for (size_t r = 0; r < given.rows(); ++r)
    for (size_t d = 0; d < drift.rows(); ++d) {
      if (drift.text(d, 0) != given.text(r, 1)) continue;
      const auto [first, last] = span.at(given.text(r, 1));
      const double u = (given.number(r, 2) - first) / (last - first);
      EXPECT_NEAR(given.number(r, 5) - truth.number(r, 5), above + drift.number(d, 3) + u * drift.number(d, 6), 0.06);
    }
}

/// A principal distance in metres for one in millimetres: thousands of millions of points.
TEST(CameraFiles, MorePointsThanFitAreRefused) {
  const test::TemporaryFolder folder;
  Options o = small_flight();
  o.camera.f = core::Metres(50.0);
  try {
    run(o, folder.path(), {});
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("million tie points"), std::string::npos) << e.text();
  }
}

}  // namespace
}  // namespace swath::simulate
