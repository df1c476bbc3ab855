// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/flight_charts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "core/geo/geodesy.h"
#include "core/time.h"

namespace swath::report {
namespace {

using Eigen::Vector3d;

constexpr double arc_second = core::degree / 3600.0;

/// Ten minutes north at 50 m/s with a heading that sways through north; every number of a series is known.
struct Made {
  core::TrajectoryData trajectory;
  core::SmootherSeries series;
};
Made made(double start) {
  Made r;
  core::TrajectoryData& t = r.trajectory;
  for (int i = 0; i <= 6000; ++i) {
    const double s = 0.1 * i;
    t.time.push_back(start + s);
    t.latitude.push_back(0.8 + 50.0 * s / (core::meridian_radius(0.8) + 1000.0));
    t.longitude.push_back(0.2);
    t.height.push_back(1000.0);
    t.roll.push_back(0.1);
    t.pitch.push_back(0.05);
    t.heading.push_back(std::fmod(0.02 * std::sin(0.1 * s) + 2 * core::pi, 2 * core::pi));
  }
  core::SmootherSeries& s = r.series;
  for (int k = 0; k <= 600; ++k) {
    core::CovarianceSeries::Matrix9 m = core::CovarianceSeries::Matrix9::Zero();
    m.diagonal() << 1e-4, 4e-4, 9e-4, 1e-4, 1e-4, 1e-4, 1e-8, 1e-8, 4e-8;
    t.covariance.time.push_back(start + k);
    t.covariance.upper.push_back(core::CovarianceSeries::pack(m));
    s.time.push_back(start + k);
    s.separation.emplace_back(0.01, 0.02, 0.03);
    s.separation_sigma.emplace_back(0.02, 0.02, 0.04);
    s.attitude_separation.push_back(Vector3d(1, 2, 3) * arc_second);
    s.heading_forward.push_back(k < 60 ? 0.1 : 5 * arc_second * std::sin(0.05 * k));
    s.gyro_bias.push_back(Vector3d(1, 2, 3) * arc_second);
    s.gyro_bias_sigma.push_back(Vector3d(0.5, 0.5, 0.5) * arc_second);
    s.accelerometer_bias.push_back(Vector3d(1, 2, 3) * 9.80665e-6);
    s.accelerometer_bias_sigma.push_back(Vector3d(1, 1, 1) * 9.80665e-6);
    s.fix_time.push_back(start + k);
    s.innovation.emplace_back(0.03, -0.03, k == 300 ? 2.0 : 0.05);
    s.innovation_sigma.emplace_back(0.04, 0.04, 0.06);
    s.residual.emplace_back(0.01, 0.01, 0.02);
    s.nis.push_back(k == 300 ? 900.0 : 3.0);
    s.weight.push_back(k == 300 ? 0.01 : 1.0);
  }
  return r;
}

core::GnssData fixes(const Made& r) {
  core::GnssData g;
  for (size_t i = 0; i < r.trajectory.size(); i += 10) {
    g.time.push_back(r.trajectory.time[i]);
    g.position.push_back(core::ecef_of({r.trajectory.latitude[i], r.trajectory.longitude[i], r.trajectory.height[i]}));
    g.quality.push_back(i < 1000 ? core::FixQuality::float_ambiguity : core::FixQuality::fixed);
    g.satellites.push_back(8);
  }
  return g;
}

std::map<std::string, Chart> charts(const std::optional<core::TrajectoryErrors>& errors = std::nullopt) {
  const auto r = made(core::from_week(2317, 474000.0));
  std::map<std::string, Chart> out;
  for (NamedChart& c : flight_charts(r.trajectory, r.series, fixes(r), errors)) out[c.name] = std::move(c.chart);
  return out;
}

TEST(FlightCharts, TheTrackIsInLocalMetresWithItsFixesByQuality) {
  const Panel p = charts()["track"].panels.at(0);
  EXPECT_TRUE(p.equal_scale);
  ASSERT_EQ(p.series.size(), 3u);
  EXPECT_EQ(p.series[2].name, "trajectory");
  EXPECT_NEAR(p.series[2].y.front(), 0.0, 1e-9);
  EXPECT_NEAR(p.series[2].y.back(), 30000.0, 80.0);  // the Earth curves away and the radius changes
  for (const double east : p.series[2].x) EXPECT_NEAR(east, 0.0, 1e-3);
  EXPECT_EQ(p.series[0].name, "float");
  EXPECT_EQ(p.series[0].x.size(), 100u);
  EXPECT_EQ(p.series[1].name, "fixed");
  EXPECT_EQ(p.series[1].x.size(), 501u);
  EXPECT_NE(p.series[0].colour, p.series[1].colour);
}

TEST(FlightCharts, UnitsAndTimesAreThoseOfTheLabels) {
  auto all = charts();
  const Chart sigma = all["sigma"];
  EXPECT_NEAR(sigma.panels[0].series[2].y[5], 0.03, 1e-7);
  EXPECT_EQ(sigma.panels[0].y_label, "sigma (m)");
  EXPECT_NEAR(sigma.panels[1].series[2].y[5], 2e-4 / arc_second, 1e-3);
  EXPECT_EQ(sigma.panels[1].x_label, "time in GPS week 2317 (s)");
  EXPECT_NEAR(sigma.panels[1].series[2].x[5], 474005.0, 1e-6);
  const Chart separation = all["separation"];
  ASSERT_EQ(separation.panels.size(), 3u);
  EXPECT_EQ(separation.panels[2].series[0].mark, Mark::band);
  EXPECT_NEAR(separation.panels[2].series[0].y[0], 0.04, 1e-12);
  EXPECT_NEAR(separation.panels[2].series[1].y[0], 0.03, 1e-12);
  EXPECT_NEAR(all["separation_attitude"].panels[2].series[0].y[0], 3.0, 1e-9);
  const Chart biases = all["biases"];
  ASSERT_EQ(biases.panels.size(), 6u);
  EXPECT_EQ(biases.panels[1].y_label, "deg/h");
  EXPECT_NEAR(biases.panels[1].series[1].y[0], 2.0, 1e-9);
  EXPECT_NEAR(biases.panels[1].series[0].y[0], 2.5, 1e-9);
  EXPECT_NEAR(biases.panels[1].series[0].y2[0], 1.5, 1e-9);
  EXPECT_NEAR(biases.panels[5].series[1].y[0], 3.0, 1e-9);
  EXPECT_NEAR(all["residuals"].panels[2].series[0].y[0], 0.02, 1e-12);
}

TEST(FlightCharts, DownWeightedFixesAreMarked) {
  const Chart c = charts()["innovations"];
  ASSERT_EQ(c.panels.size(), 4u);
  const auto& series = c.panels[2].series;
  EXPECT_EQ(series[2].name, "down-weighted");
  EXPECT_TRUE(std::isnan(series[1].y[300]));
  EXPECT_NEAR(series[2].y[300], 2.0, 1e-12);
  EXPECT_TRUE(std::isnan(series[2].y[299]));
  EXPECT_TRUE(c.panels[3].log_y);
}

TEST(FlightCharts, HeadingBreaksAtNorthAndIsSeenAfterItsAlignment) {
  auto all = charts();
  const auto& heading = all["attitude"].panels[1].series[0].y;
  int breaks = 0;
  for (size_t i = 1; i < heading.size(); ++i) {
    breaks += std::isnan(heading[i]);
    if (!std::isnan(heading[i]) && !std::isnan(heading[i - 1])) {
      EXPECT_LT(std::abs(heading[i] - heading[i - 1]), 180.0);
    }
  }
  EXPECT_EQ(breaks, 19);  // 9.5 turns of the sway
  ASSERT_EQ(all["heading"].panels.size(), 2u);
  EXPECT_EQ(all["heading"].panels[0].y_share, 1.0);
  EXPECT_LT(all["heading"].panels[1].y_share, 0.9);  // the first tenth of the flight is its alignment
}

TEST(FlightCharts, ErrorsAppearWhereTruthIsKnownAndEveryChartDraws) {
  core::TrajectoryErrors e;
  for (int i = 0; i < 1000; ++i) {
    e.time.push_back(core::from_week(2317, 474000.0) + i);
    e.position.emplace_back(0.01, 0.02, -0.03);
    e.attitude.push_back(Vector3d(1, -2, 30) * arc_second);
    e.position_sigma.emplace_back(0.02, 0.02, 0.04);
    e.attitude_sigma.push_back(Vector3d(5, 5, 20) * arc_second);
  }
  auto all = charts(e);
  EXPECT_EQ(all.size(), 11u);
  EXPECT_EQ(charts().size(), 9u);
  EXPECT_NEAR(all["errors_attitude"].panels[2].series[1].y[0], 30.0, 1e-9);
  EXPECT_NEAR(all["errors_position"].panels[2].series[0].y[0], 0.04, 1e-12);
  for (const auto& [name, chart] : all) {
    EXPECT_GT(draw(chart).height, 200) << name;
    EXPECT_NE(svg(chart).find(chart.title), std::string::npos);
  }
}

TEST(FlightCharts, AnEmptyResultStillDraws) {
  for (const NamedChart& c : flight_charts({}, {}, {})) EXPECT_GT(draw(c.chart).height, 0) << c.name;
}

}  // namespace
}  // namespace swath::report
