// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/adjust/calibrate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "tests/calib/tie_world.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr double height = 400.0;
constexpr double arcsec = core::degree / 3600;

/// Houses seen to and fro, across, and from beside; the trajectory shifted by 2 cm from line to line.
struct Flight {
  test::TieWorld world;
  test::Flown flown;
  std::optional<trajectory::Trajectory> trajectory;
  std::optional<trajectory::ErrorModel> errors;

  explicit Flight(const std::vector<test::Track>& tracks, bool houses = true) {
    if (houses) world.houses = test::village(25, 150.0, 3);
    world.prf = 20000.0;
    world.truth.roll = core::degrees(0.31);
    world.truth.pitch = core::degrees(-0.22);
    world.truth.heading = core::degrees(0.43);
    world.truth.scan_scale = 1.0002;
    flown = test::fly(world, tracks, 5, 0.02);
    trajectory.emplace(flown.data);
    trajectory::ErrorModelOptions stated;
    stated.horizontal = stated.vertical = core::Metres(0.02);
    stated.roll_pitch = stated.heading = core::degrees(1e-4);  // the made trajectory's attitude has no error
    errors.emplace(trajectory->data(), stated);
  }
  CalibrationFlight described() const {
    CalibrationFlight f;
    f.shots = flown.stream();
    f.scanner = world.scanner;
    f.sensor.range = core::Metres(world.range_noise);
    f.sensor.scan_angle = core::Radians(1e-6);
    f.trajectory = &*trajectory;
    f.errors = &*errors;
    f.frame = world.frame;
    return f;
  }
  Calibrated calibrated(const CalibrateOptions& options = {}) const {
    core::Tally tally;
    return calibrate(described(), options, tally);
  }
};

std::vector<test::Track> pattern() {
  return {{{0, 0}, height, 0.3, 400},
          {{0, 0}, height, 0.3 + core::pi, 400},
          {{0, 0}, height, 0.3 + core::pi / 2, 400},
          {{0, 0}, height, 0.3 - core::pi / 2, 400},
          {{90, -30}, height, 0.3, 400}};
}

TEST(Calibrate, FromADegreeToArcSeconds) {
  const Flight flight(pattern());
  const Calibrated c = flight.calibrated();
  ASSERT_TRUE(c.match);
  EXPECT_GE(c.rounds, 2);
  EXPECT_GT(c.ties.planes.size(), 40u);
  ASSERT_FALSE(c.notes.empty());
  const core::Calibration& found = c.adjustment.calibration;
  const auto near = [&](Parameter p, double value, double truth, double most) {
    const Estimate& e = c.adjustment.estimates[static_cast<size_t>(p)];
    EXPECT_TRUE(e.estimated);
    EXPECT_LT(std::abs(value - truth), 3.5 * e.sigma) << "parameter " << p;
    EXPECT_LT(e.sigma, most) << "parameter " << p;
  };
  near(boresight_roll, found.roll.value, flight.world.truth.roll.value, 10 * arcsec);
  near(boresight_pitch, found.pitch.value, flight.world.truth.pitch.value, 15 * arcsec);  // the lever arm's stated sigma is in it
  near(boresight_heading, found.heading.value, flight.world.truth.heading.value, 25 * arcsec);
  near(scan_scale, found.scan_scale, flight.world.truth.scan_scale, 1e-4);
}

TEST(Calibrate, OneRoundIsOneRound) {
  const Flight flight(pattern());
  CalibrateOptions options;
  options.rounds = 1;
  options.adjust.jackknife.blocks = 0;
  const Calibrated c = flight.calibrated(options);
  EXPECT_EQ(c.rounds, 1);
  options.coarse = false;
  options.planes.mismatch = core::Metres(5.0);
  EXPECT_FALSE(flight.calibrated(options).match);
}

TEST(Calibrate, ASurveyedTargetThatNoLineShowsIsTold) {
  const Flight flight(pattern());
  CalibrationFlight described = flight.described();
  SurveyedTarget far;
  far.name = "far roof";
  far.corners = {{900, 900, 5}, {920, 900, 5}, {920, 920, 5}, {900, 920, 5}};
  far.centre = {910, 910, 5};
  for (const Vector3d& c : far.corners) far.control.push_back({c, 0.02, "corner"});
  described.targets = {far};
  CalibrateOptions options;
  options.rounds = 1;
  options.adjust.jackknife.lines = false;
  options.adjust.jackknife.blocks = 0;
  core::Tally tally;
  const Calibrated c = calibrate(described, options, tally);
  EXPECT_TRUE(std::any_of(c.notes.begin(), c.notes.end(),
                          [](const std::string& n) { return n.starts_with("A surveyed target takes no part: far roof: "); }));
}

TEST(Calibrate, WithoutOverlapItIsRefused) {
  const Flight flight({{{0, 0}, height, 0.3, 300}, {{3000, 0}, height, 0.3, 300}});
  try {
    flight.calibrated();
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("no plane was found that two lines have seen"), std::string::npos) << e.what();
  }
}

TEST(Calibrate, TheSignOfTheScanAngleIsRefused) {
  Flight flight(pattern());
  for (auto& [id, shots] : flight.flown.lines)
    for (double& a : shots.angle) a = -a;
  try {
    flight.calibrated();
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("sign of the scan angle"), std::string::npos) << e.what();
  }
}

TEST(Calibrate, TheMismatchOfThePlanesIsThatOfTheFirstRound) {
  const Flight flight(pattern());  // lines lie up to five metres apart
  CalibrateOptions options;
  options.rounds = 1;
  options.coarse = false;
  options.adjust.jackknife.blocks = 0;
  options.adjust.jackknife.lines = false;
  const auto planes = [&](double mismatch) {
    options.planes.mismatch = core::Metres(mismatch);
    return flight.calibrated(options).ties.planes.size();
  };
  EXPECT_NE(planes(5.0), planes(0.1));
}

TEST(Calibrate, TheSignOfTheScanAngleIsRefusedWithoutTheCoarseStepToo) {
  Flight flight(pattern());
  CalibrateOptions options;
  options.coarse = false;
  options.planes.mismatch = core::Metres(5.0);
  EXPECT_NO_THROW(refuse_reversed_scan(flight.described()));
  for (auto& [id, shots] : flight.flown.lines)
    for (double& a : shots.angle) a = -a;
  try {
    flight.calibrated(options);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(std::string(e.what()).find("sign of the scan angle"), std::string::npos) << e.what();
    EXPECT_NE(e.hint().find("angle_to_port"), std::string::npos) << e.hint();
  }
}

TEST(Calibrate, AnImuTurnedAboutTheVerticalIsNamedAsThat) {
  Flight flight(pattern());
  core::TrajectoryData turned = flight.flown.data;
  for (size_t k = 0; k < turned.size(); ++k) {
    turned.heading[k] = core::wrap_two_pi(turned.heading[k] + core::pi);
    turned.roll[k] = -turned.roll[k];
    turned.pitch[k] = -turned.pitch[k];
  }
  flight.trajectory.emplace(turned);
  for (const bool coarse : {true, false}) {
    CalibrateOptions options;
    options.coarse = coarse;
    try {
      flight.calibrated(options);
      ADD_FAILURE() << "not refused";
    } catch (const core::Error& e) {
      EXPECT_NE(std::string(e.what()).find("the IMU is turned by 180 deg about the vertical"), std::string::npos) << e.text();
      EXPECT_EQ(e.hint().find("angle_to_port"), std::string::npos) << e.hint();
    }
  }
}

TEST(Calibrate, AFrameAmidTheLinesAtTheGround) {
  const Flight flight(pattern());
  std::vector<std::pair<double, double>> times;
  for (const auto& [id, shots] : flight.flown.lines) times.emplace_back(shots.time.front(), shots.time.back());
  const trajectory::LocalFrame frame = frame_of(times, height, *flight.trajectory);
  const Vector3d local = flight.world.frame.local_R_ecef * (frame.origin - flight.world.frame.origin);
  EXPECT_LT(local.head<2>().norm(), 30.0) << "four lines over the middle, one 95 m aside";
  EXPECT_NEAR(local.z(), 0.0, 2.0);
  EXPECT_THROW(frame_of({{0.0, 1.0}}, height, *flight.trajectory), core::Error);
}

}  // namespace
}  // namespace swath::calib
