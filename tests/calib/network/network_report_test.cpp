// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/network/network_report.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calib/report/page.h"
#include "calib/report/report_tree.h"
#include "calib/report/tables.h"
#include "calib/report_units.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/text/value_file.h"

namespace swath::calib {
namespace {

constexpr double start = 2317.0 * 604800.0 + 1000.0, shift_north = 0.05, turn = 2e-4;

/// Northward at 50 m/s for 20 s; all sigmas `sigma` m and a hundredth of it in rad.
trajectory::Trajectory flight(double north, double roll, double sigma) {
  core::TrajectoryData d;
  core::CovarianceSeries::Matrix9 C = core::CovarianceSeries::Matrix9::Zero();
  C.diagonal().setConstant(sigma * sigma);
  C.diagonal().tail<3>() *= 1e-4;
  for (int i = 0; i <= 400; ++i) {
    const double t = 0.05 * i;
    d.time.push_back(start + t);
    d.latitude.push_back(0.8 + (50.0 * t + north) / 6.37e6), d.longitude.push_back(0.2), d.height.push_back(900.0);
    d.roll.push_back(0.01 + roll), d.pitch.push_back(0.0), d.heading.push_back(0.0);
    d.v_north.push_back(50.0), d.v_east.push_back(0.0), d.v_down.push_back(0.0);
    d.covariance.time.push_back(start + t);
    d.covariance.upper.push_back(core::CovarianceSeries::pack(C));
  }
  return trajectory::Trajectory(std::move(d), {}, "made");
}

AdjustedNetwork made() {
  AdjustedNetwork n;
  n.ties.lines = {{1, start + 1, start + 8}, {2, start + 10, start + 19}};
  TiePlane p;
  p.centre.setZero();
  p.normal = Eigen::Vector3d::UnitZ();
  n.ties.planes = n.planes = {p};
  n.ties.groups = {{0, 0, 0, 40}, {0, 1, 40, 80}};
  n.before = {{0, 0, 0.10, 0.003, 1.0, 40}, {0, 1, -0.10, 0.003, 1.0, 40}};
  n.after = {{0, 0, 0.002, 0.003, 1.0, 40}, {0, 1, -0.002, 0.003, 1.0, 40}};
  n.tests.group = {{0.7, 0.4, 0.005}, {-0.7, 0.4, -0.005}};
  n.tests.plane_sigma = {Eigen::Vector3d(0.01, 1e-3, 1e-3)};
  n.components = {{"imu", "IMU", 1000, 10.0, 1.05}, {"gnss_position", "GNSS position", 60, 50.0, 0.95}};
  n.sigmas = {{"range", 0.02, 1.3, 900.0, true}, {"surface", 0.003, 1.0, 4.0, false}};
  n.values = {{boresight_roll, 0.001, 2e-4, 0.0012, 1e-4}};
  n.calibration.roll = core::Radians(0.0012);
  n.covariance = Eigen::MatrixXd::Constant(1, 1, 1e-8);
  n.settled = true;
  n.rounds = 2, n.iterations = 6, n.unknowns = 100;
  for (int i = 0; i < 3; ++i)
    n.biases.push_back({start + i, Eigen::Vector3d::Constant(1e-5), Eigen::Vector3d::Constant(1e-6), Eigen::Vector3d::Constant(0.02),
                        Eigen::Vector3d::Constant(0.001)});
  return n;
}

TEST(NetworkReport, CorrectionsAreTheTrajectoriesDifference) {
  CalibrationReport report;
  put_network(made(), flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), report);
  ASSERT_EQ(report.adjustment.corrections.size(), 2u);
  for (const LineCorrection& c : report.adjustment.corrections) {
    ASSERT_FALSE(c.time.empty());
    for (size_t k = 0; k < c.time.size(); ++k) {
      EXPECT_NEAR(c.value[k][0], shift_north, 2e-4);  // 6.37e6 m is not quite this meridian's radius
      for (const size_t axis : {1u, 2u}) EXPECT_NEAR(c.value[k][axis], 0.0, 1e-6);
      EXPECT_NEAR(c.value[k][3], turn, 1e-7);
      EXPECT_NEAR(c.sigma[k][0], 0.06, 1e-9);
      EXPECT_NEAR(c.apriori[k][5], 1e-3, 1e-9);
    }
  }
}

TEST(NetworkReport, GroupsAndValuesAreTheAdjustments) {
  CalibrationReport report;
  put_network(made(), flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), report);
  const Adjustment& a = report.adjustment;
  ASSERT_EQ(a.groups.size(), 2u);
  EXPECT_EQ(a.groups[1].before, -0.10);
  EXPECT_EQ(a.groups[1].w, -0.7);
  EXPECT_FALSE(a.groups[1].rejected);
  ASSERT_TRUE(report.strips);
  EXPECT_NEAR(report.strips->all.rms_before, 0.20, 1e-12);
  EXPECT_NEAR(report.strips->all.rms_after, 0.004, 1e-12);
  const Estimate& roll = a.estimates[boresight_roll];
  EXPECT_TRUE(roll.estimated);
  EXPECT_EQ(roll.value, 0.0012);
  EXPECT_NEAR(roll.determined, 0.75, 1e-12);
  EXPECT_FALSE(a.estimates[boresight_pitch].estimated);
  EXPECT_NEAR(a.sigma0, std::sqrt((1.05 * 1.05 * 10 + 0.95 * 0.95 * 50) / 60), 1e-12);
}

TEST(NetworkReport, ThePageSaysWhatTheSurfacesChanged) {
  CalibrationReport report;
  put_network(made(), flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), report);
  EXPECT_STREQ(tree_file(report), "adjustment.json");
  std::vector<std::string> files;
  const std::string html = calibration_page(report, [&](const std::string& file, const core::Picture&) {
    files.push_back(file);
    return std::string("png");
  });
  EXPECT_NE(html.find("Joint adjustment"), std::string::npos);
  EXPECT_NE(html.find("5.00 / 8.00"), std::string::npos);  // north: found, and sqrt(10^2 - 6^2) cm
  EXPECT_NE(html.find("GNSS position"), std::string::npos);
  EXPECT_EQ(html.find("gnss_position"), std::string::npos);
  // What calib.adjust alone has, and what it says of its files.
  for (const char* of_calibration : {"jackknife", "condition number", "knots", "as it was given", "everything in this report"})
    EXPECT_EQ(html.find(of_calibration), std::string::npos) << of_calibration;
  EXPECT_NE(html.find("found / stated"), std::string::npos);
  EXPECT_NE(html.find("network.json"), std::string::npos);
  EXPECT_NE(html.find("Biases of the IMU"), std::string::npos);
  EXPECT_NE(html.find("values-angles"), std::string::npos);
  EXPECT_NE(std::find(files.begin(), files.end(), "figures/biases.png"), files.end());
}

TEST(NetworkReport, TheTreeHasValuesAndSigmasAndClaimsNothingElse) {
  AdjustedNetwork n = made();
  n.values.push_back({boresight_heading, 0.0, 2e-4, 1e-5, 1.9e-4});  // hardly known better than before
  n.values.push_back({boresight_pitch, 0.0, 1e-2, 1e-5, 1e-3});      // 0.06 deg
  n.covariance = Eigen::Vector3d(1e-8, 3.61e-8, 1e-6).asDiagonal();
  CalibrationReport report;
  put_network(n, flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), report);
  EXPECT_EQ(report.adjustment.estimates[boresight_roll].grade, Grade::coarse);  // 1e-4 rad is beyond 0.005 deg
  EXPECT_EQ(report.adjustment.estimates[boresight_heading].grade, Grade::undetermined);
  EXPECT_EQ(report.adjustment.estimates[boresight_pitch].grade, Grade::coarse);
  const core::Value tree = calibration_report_tree(report);
  ASSERT_NE(tree.find("estimates"), nullptr);
  EXPECT_EQ(tree.find("estimates")->items().size(), static_cast<size_t>(latency) + 1);
  ASSERT_NE(tree.find("variance_components"), nullptr);
  EXPECT_EQ(tree.find("variance_components")->items().size(), 2u);
  const std::string text = io::to_json(tree);
  EXPECT_EQ(text.find("\"condition\": 0"), std::string::npos);
}

TEST(NetworkReport, ALineMovedBeyondItsSigmasIsAFinding) {
  CalibrationReport report;
  put_network(made(), flight(0.0, 0.0, 0.1), flight(10 * shift_north, turn, 0.06), report);
  ASSERT_EQ(report.adjustment.findings.size(), 2u);  // both lines
  EXPECT_NE(report.adjustment.findings[1].what.find("line 2: the surfaces move the smoother's trajectory by 50.0 cm north, 6.2 times"),
            std::string::npos)
      << report.adjustment.findings[1].what;
  CalibrationReport right;
  put_network(made(), flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), right);
  EXPECT_TRUE(right.adjustment.findings.empty());
}

TEST(NetworkReport, StatesThatStillMoveAreAFinding) {
  AdjustedNetwork n = made();
  n.settled = false;
  CalibrationReport report;
  put_network(n, flight(0.0, 0.0, 0.1), flight(shift_north, turn, 0.06), report);
  EXPECT_EQ(report.adjustment.findings.size(), 1u);
}

}  // namespace
}  // namespace swath::calib
