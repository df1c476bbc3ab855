// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/error_budget.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/config/units.h"
#include "core/geo/crs.h"
#include "core/geo/frames.h"
#include "georef/georeference.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::planning {
namespace {

using core::degree;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double table_angle = -20 * degree;  // b of the table: the point lies to port
constexpr double tenth_of_a_millimetre = 1e-4;

ErrorSources table_sources() { return {0.03 * degree, 0.03 * degree, 0.04 * degree, 0.02 * degree, -0.05, 0.08, 0.08, 0.08}; }

/// Against the printed table, rounded to whole centimetres: 107 of 108 cells. The vector holds what the oracle computed to all digits.
TEST(ErrorBudget, TableTen) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p004_table10.json");
  const core::Value all = io::read_value_file(file);
  int cells = 0, as_printed = 0;
  for (const auto& [height, rows] : all.find("oracle")->members()) {
    const double h = std::stod(height);
    const ErrorBudget nadir = error_budget(table_sources(), h, 0), edge = error_budget(table_sources(), h, -table_angle);
    const core::Value& printed = *all.find("printed")->find(height);
    size_t k = 0;
    for (const auto& [name, row] : rows.members()) {
      const bool is_total = name == "EMQ";
      const Vector3d a = is_total ? nadir.total() : nadir.by_source.at(k), b = is_total ? edge.total() : edge.by_source.at(k);
      for (int axis = 0; axis < 3; ++axis)
        for (int side = 0; side < 2; ++side) {
          const double cm = 100 * (side == 0 ? a : b)[axis];
          const auto column = static_cast<size_t>(2 * axis + side);
          EXPECT_NEAR(cm, row.items()[column].as_number(), 0.01) << height << " " << name << " " << column;
          ++cells;
          if (std::abs(std::round(cm) - printed.find(name)->items()[column].as_number()) < 0.5) ++as_printed;
        }
      ++k;
    }
  }
  EXPECT_EQ(cells, 108);
  EXPECT_EQ(as_printed, 107);  // heading, X at 20 deg, 1200 m: 30.49 is printed as 31
  for (const auto& [name, rows] : all.find("more")->members()) {
    const double h = std::stod(name.substr(1)), angle = std::stod(name.substr(name.find('b') + 1)) * degree;
    const ErrorBudget budget = error_budget(table_sources(), h, angle);
    size_t k = 0;
    for (const auto& [source, row] : rows.members()) {
      const Vector3d e = source == "EMQ" ? budget.total() : budget.by_source.at(k++);
      for (size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(100 * e[static_cast<Eigen::Index>(axis)], row.items()[axis].as_number(), 0.01) << name << " " << source;
    }
  }
}

/// The point as the table's frame has it, X along, Z up: every error is the central difference of it.
Vector3d point(const ErrorSources& e, double height, double angle) {
  const double range = height / std::cos(angle) + e.range, b = -angle + e.scan_angle;
  const Vector3d beam(0, std::sin(b), -std::cos(b));
  const Matrix3d turn = (Eigen::AngleAxisd(e.heading, Vector3d::UnitZ()) * Eigen::AngleAxisd(e.pitch, Vector3d::UnitY()) *
                         Eigen::AngleAxisd(e.roll, Vector3d::UnitX()))
                            .toRotationMatrix();
  return Vector3d(e.along, e.across, e.up) + range * (turn * beam);
}

TEST(ErrorBudget, IsTheDerivativeOfAPoint) {
  constexpr double d = 1e-6;
  for (const double angle : {0.0, 0.2, -0.45}) {
    const auto numeric = [&](double ErrorSources::*source) {
      ErrorSources plus, minus;
      plus.*source = d;
      minus.*source = -d;
      return Vector3d((point(plus, 700, angle) - point(minus, 700, angle)) / (2 * d));
    };
    const std::array<double ErrorSources::*, 8> sources{&ErrorSources::roll,       &ErrorSources::pitch, &ErrorSources::heading,
                                                        &ErrorSources::scan_angle, &ErrorSources::range, &ErrorSources::along,
                                                        &ErrorSources::across,     &ErrorSources::up};
    const ErrorBudget b = error_budget({1, 1, 1, 1, 1, 1, 1, 1}, 700, angle);
    for (size_t k = 0; k < sources.size(); ++k) EXPECT_LT((b.by_source[k] - numeric(sources[k])).norm(), 1e-5) << source_names[k];
  }
}

/// On a slope across the track an error of the place is one of the height.
TEST(ErrorBudget, ASlopeAddsTheErrorOfThePlace) {
  ErrorSources s;
  s.across = 0.3;
  s.up = 0.04;
  const ErrorBudget b = error_budget(s, 500, 0.1);
  EXPECT_NEAR(surface_sigma(b, 0, 0), 0.04, 1e-12);
  EXPECT_NEAR(surface_sigma(b, 0, 0.5), std::hypot(0.04, 0.15), 1e-12);
  EXPECT_NEAR(surface_sigma(b, 0.5, 0), 0.04, 1e-12);
}

TEST(ErrorBudget, SourcesOfASurvey) {
  core::SensorSigma sensor;
  sensor.range = core::Metres(0.03);
  sensor.range_scale = 1e-4;
  sensor.roll = core::Radians(3e-4);
  TrajectorySigma t;
  t.roll_pitch = core::Radians(4e-4);
  t.vertical = core::Metres(0.05);
  const ErrorSources s = sources_of(sensor, t, 300, 0, 0);
  EXPECT_NEAR(s.roll, 5e-4, 1e-12);
  EXPECT_NEAR(s.range, std::hypot(0.03, 0.03), 1e-12);
  EXPECT_NEAR(s.up, std::hypot(0.05, sensor.lever_arm.value), 1e-12);
  EXPECT_EQ(s.along, s.across);
  sensor.latency = core::Seconds(3e-4);
  sensor.time = core::Seconds(4e-4);
  EXPECT_NEAR(sources_of(sensor, t, 300, 0, 60).along, std::hypot(s.across, 0.03), 1e-12);
}

/// The TPU that georeferencing gives to each point of a level flight northward, against the budget at its scan angle.
TEST(ErrorBudget, IsTheSigmaOfDeliveredPoints) {
  constexpr double start = 1.4e9, height = 800, speed = 60,
                   same = 2e-3;  // same: m; the aircraft's height above the ellipsoid's curve, and float columns
  core::TrajectoryData t;
  TrajectorySigma s;
  s.horizontal = core::Metres(0.04);
  s.vertical = core::Metres(0.05);
  s.roll_pitch = core::degrees(0.004);
  s.heading = core::degrees(0.009);
  for (int k = 0; k <= 400; ++k) {
    t.time.push_back(start + 0.01 * k);
    t.latitude.push_back(47.9 * degree + speed * 0.01 * k / 6.366e6);
    t.longitude.push_back(10.5 * degree);
    t.height.push_back(height);
    t.roll.push_back(0);
    t.pitch.push_back(0);
    t.heading.push_back(0);
    for (auto* column : {&t.sigma_north, &t.sigma_east}) column->push_back(static_cast<float>(s.horizontal.value));
    t.sigma_down.push_back(static_cast<float>(s.vertical.value));
    for (auto* column : {&t.sigma_roll, &t.sigma_pitch}) column->push_back(static_cast<float>(s.roll_pitch.value));
    t.sigma_heading.push_back(static_cast<float>(s.heading.value));
  }
  core::SensorSigma sensor;
  sensor.range = core::Metres(0.03);
  sensor.scan_angle = core::degrees(0.003);
  sensor.scan_offset = core::degrees(0.002);
  sensor.range_scale = 3e-5;
  sensor.beam_divergence = core::Radians(4e-4);
  sensor.latency = core::Seconds(2e-4);
  const trajectory::Trajectory flight(t);
  core::Shots shots;
  const std::vector<double> angles{-0.45, -0.2, 0.0, 0.1, 0.35};
  for (size_t k = 0; k < angles.size(); ++k) {
    shots.time.push_back(start + 1.0 + 0.3 * static_cast<double>(k));
    shots.angle.push_back(angles[k]);
    shots.range.push_back(height / std::cos(angles[k]));
  }
  core::Block out;
  georef::Georeferencer({}, {}, sensor, flight, core::Crs("EPSG:32632"), Vector3d::Zero()).run(shots, out);
  ASSERT_EQ(out.size(), angles.size());
  for (size_t k = 0; k < angles.size(); ++k) {
    const Vector3d e = error_budget(sources_of(sensor, s, height, angles[k], speed), height, angles[k]).total();
    EXPECT_NEAR(e.head<2>().norm(), static_cast<double>(out.sigma_h[k]), same) << angles[k];
    EXPECT_NEAR(e.z(), static_cast<double>(out.sigma_v[k]), same) << angles[k];
  }
}

TEST(ErrorBudget, ForestAndReference) {
  EXPECT_NEAR(*forest_sigma(0.0, 0.3), 0.10, 1e-12);
  EXPECT_NEAR(*forest_sigma(std::atan(0.5), 0.25), 0.70, 1e-12);
  EXPECT_FALSE(forest_sigma(0.1, 0.24));
  EXPECT_FALSE(forest_sigma(0.1, std::nan("")));
  EXPECT_NEAR(without_reference(0.5, 0.3), 0.4, tenth_of_a_millimetre);
  EXPECT_NEAR(without_reference(0.3, 0.5), -0.4, tenth_of_a_millimetre);  // the reference explains more than all
}

}  // namespace
}  // namespace swath::planning
