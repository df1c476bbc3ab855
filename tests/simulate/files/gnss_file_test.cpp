// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/gnss_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/geodesy.h"
#include "io/text/delimited.h"
#include "simulate/planned_flight.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Vector3d;

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};
const std::array<core::Metres, 3> lever{core::Metres(-0.4), core::Metres(0.1), core::Metres(-1.2)};

PlannedFlight flight(double metres = 3000.0) {
  FlightOptions o;
  o.lines = 1;
  o.cross_lines = 0;
  o.line_length = core::Metres(metres);
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, 0.3, 0.0), 5.2, 1);
}

std::vector<Fix> fixes(const Flight& f, const GnssOptions& o, bool noise_free = false, std::int64_t seed = 1) {
  Receiver r(f, o, lever, noise_free, seed);
  std::vector<Fix> out;
  while (const auto fix = r.next()) out.push_back(*fix);
  return out;
}

/// North, east, down of the recorded position from the true antenna at `t`.
Vector3d error_of(const Flight& f, const Fix& fix, double t) {
  const Pose p = f.pose(t);
  const Eigen::Matrix3d R = core::ecef_R_ned(p.position.latitude, p.position.longitude);
  const Vector3d antenna(lever[0].value, lever[1].value, lever[2].value);
  return R.transpose() * (fix.position - core::ecef_of(p.position)) - core::matrix_of(p.attitude) * antenna;
}

TEST(GnssFile, StatedSigmasHoldWhiteAndCorrelatedPartInTheirShares) {
  const PlannedFlight f = flight(100000.0);  // 2000 s
  GnssOptions o;
  o.correlation_time = core::Seconds(120.0);
  o.rate.value = 1.0;
  double white = 0, correlated = 0, lagged = 0, lag_base = 0, total = 0, sigma = 0;
  size_t n = 0;
  for (int seed = 1; seed <= 12; ++seed) {
    const std::vector<Fix> all = fixes(f, o, false, seed);
    for (size_t i = 0; i < all.size(); ++i, ++n) {
      const Fix& x = all[i];
      white += x.white.cwiseQuotient(x.sigma).squaredNorm() / 3;
      const Vector3d c = x.correlated.cwiseQuotient(x.sigma);
      correlated += c.squaredNorm() / 3;
      total += error_of(f, x, x.tag).cwiseQuotient(x.sigma).squaredNorm() / 3;
      sigma += x.sigma.x() * x.sigma.x();
      if (i + 120 < all.size()) {
        lag_base += c.squaredNorm() / 3;
        lagged += c.dot(all[i + 120].correlated.cwiseQuotient(all[i + 120].sigma)) / 3;
      }
    }
  }
  const auto count = static_cast<double>(n);
  // 24 000 fixes in three axes; the correlated part has 300 independent values of each: five sigma of a variance are 0.24 of it.
  EXPECT_NEAR(white / count, 0.6, 0.02);
  EXPECT_NEAR(correlated / count, 0.4, 0.4 * 0.24);
  EXPECT_NEAR(total / count, 1.0, 0.11);
  EXPECT_NEAR(lagged / lag_base, std::exp(-1.0), 0.2);
  EXPECT_NEAR(std::sqrt(sigma / count), o.sigma_horizontal.value, 0.05 * o.sigma_horizontal.value);  // 800 states of the sky
}

TEST(GnssFile, AxesAreIndependent) {
  const PlannedFlight f = flight(100000.0);
  GnssOptions o;
  o.correlation_time = core::Seconds(1.0);
  double ne = 0, nd = 0;
  const std::vector<Fix> all = fixes(f, o);
  for (const Fix& x : all) {
    const Vector3d e = (x.white + x.correlated).cwiseQuotient(x.sigma);
    ne += e.x() * e.y();
    nd += e.x() * e.z();
  }
  EXPECT_NEAR(ne / static_cast<double>(all.size()), 0.0, 0.1);  // some 5000 independent products: five sigma are 0.07
  EXPECT_NEAR(nd / static_cast<double>(all.size()), 0.0, 0.1);
}

TEST(GnssFile, OutagesAndFloatSolutionsAreWhereTheyAreAsked) {
  const PlannedFlight f = flight();
  GnssOptions o;
  o.outages = {{core::Seconds(0), core::Seconds(5)}, {core::Seconds(20), core::Seconds(10)}, {core::Seconds(60), core::Seconds(600)}};
  o.floats = {{core::Seconds(40), core::Seconds(8)}};
  const std::vector<Fix> all = fixes(f, o), whole = fixes(f, {});
  EXPECT_EQ(all.front().tag, 5.0);
  EXPECT_NEAR(all.back().tag, 59.8, 1e-9);
  EXPECT_EQ(all.size(), static_cast<size_t>(5 * (60 - 5 - 10)));
  for (const Fix& x : all) {
    EXPECT_FALSE(x.tag >= 20 && x.tag < 30);
    const bool in_float = x.tag >= 40 && x.tag < 48;
    EXPECT_EQ(x.quality, in_float ? core::FixQuality::float_ambiguity : core::FixQuality::fixed);
    EXPECT_EQ(x.sigma.x() > 0.1, in_float);
    // Outages leave the other fixes as they are.
    if (!in_float) {
      EXPECT_EQ(x.position, whole[static_cast<size_t>(std::lround(x.tag * 5))].position);
    }
  }
}

TEST(GnssFile, OutliersAreOfTheirShareAndSize) {
  const PlannedFlight f = flight(50000.0);
  GnssOptions o;
  o.outlier_share = 0.05;
  o.outlier_size = core::Metres(2.0);
  size_t n = 0;
  const std::vector<Fix> all = fixes(f, o);
  for (const Fix& x : all) {
    if (x.outlier.isZero()) continue;
    ++n;
    EXPECT_GE(x.outlier.norm(), 1.0);
    EXPECT_LE(x.outlier.norm(), 3.0);
    EXPECT_LT((error_of(f, x, x.tag) - x.white - x.correlated - x.outlier).norm(), 1e-6);
  }
  EXPECT_NEAR(static_cast<double>(n) / static_cast<double>(all.size()), 0.05, 0.016);  // 5000 fixes, five sigma
}

TEST(GnssFile, LatencyAndVelocityAreThoseOfTheAntenna) {
  const PlannedFlight f = flight();
  GnssOptions o;
  for (const double latency : {0.05, -0.05}) {
    o.latency.value = latency;
    const std::vector<Fix> all = fixes(f, o, true);
    for (const Fix& x : all) {
      EXPECT_LT(error_of(f, x, x.tag + latency).norm(), 1e-8);
      EXPECT_NEAR(x.velocity.norm(), 50.0, 2.0);
    }
    EXPECT_EQ(all.front().tag, latency < 0 ? 0.2 : 0.0);  // none before the flight
    EXPECT_EQ(all.back().tag, latency < 0 ? f.duration() : f.duration() - 0.2);
  }
  EXPECT_EQ(fixes(f, {}).back().tag, f.duration());  // the last fix ends the IMU's records too
}

TEST(GnssFile, FileHoldsTheFixesAndTheSurveyTellsTheStatedArm) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "truth");
  GnssOptions o;
  o.velocity = true;
  o.lever_arm_error = {core::Metres(0.1), core::Metres(0), core::Metres(-0.05)};
  o.latency = core::Seconds(0.02);
  o.latency_error = core::Seconds(-0.02);
  const core::GpsTime start = core::from_week(2317, 604795.003325);  // no whole millisecond
  const std::int64_t n = write_gnss(folder.path(), f, start, o, lever, false, 1);
  const std::vector<Fix> all = fixes(f, o);
  EXPECT_EQ(n, static_cast<std::int64_t>(all.size()));
  const io::DelimitedLayout layout = io::inspect_delimited(folder / "gnss.csv");
  const io::GnssFile told = describe_gnss_file(o, start);
  std::vector<size_t> columns;
  for (const auto* c : {&told.columns.time, &told.columns.x, &told.columns.y, &told.columns.z, &told.columns.cov_xx, &told.columns.cov_yy,
                        &told.columns.cov_zz, &told.columns.quality, &told.columns.v_north, &told.columns.v_up})
    columns.push_back(io::column_of(layout, *c, folder / "gnss.csv"));
  io::DelimitedReader reader(folder / "gnss.csv", layout, columns);
  std::array<double, 10> row{};
  for (const Fix& x : all) {
    ASSERT_TRUE(reader.next(row.data()));
    EXPECT_NEAR(row[0], 604795.003325 + x.tag, 2e-7);  // as a GPS time resolves it
    EXPECT_LT((Vector3d(row[1], row[2], row[3]) - x.position).norm(), 1e-4);
    EXPECT_NEAR(row[4] + row[5] + row[6], x.sigma.squaredNorm(), 1e-9);
    EXPECT_EQ(row[7], 1.0);
    EXPECT_NEAR(row[8], x.velocity.x(), 1e-5);
    EXPECT_NEAR(row[9], -x.velocity.z(), 1e-5);
  }
  const io::Antenna antenna = describe_antenna(o, lever);
  EXPECT_NEAR(antenna.lever_arm[0].value, -0.3, 1e-12);
  EXPECT_NEAR(antenna.lever_arm[2].value, -1.25, 1e-12);
  EXPECT_EQ(antenna.latency.value, 0.0);
}

}  // namespace
}  // namespace swath::simulate
