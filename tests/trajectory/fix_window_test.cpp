// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/fix_window.h"

#include <gtest/gtest.h>

#include "core/geo/geodesy.h"
#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
constexpr double rounding = 1e-9;  // m: northings of 7000 km keep 1e-9 m

std::vector<double> seconds(size_t n) {
  std::vector<double> t;
  for (size_t i = 0; i < n; ++i) t.push_back(static_cast<double>(i));
  return t;
}

TEST(FixWindow, HasSoManyFixesOnEachSide) {
  const FixWindow w = window_at(seconds(20), 9.5, 5, 2.5);
  EXPECT_EQ(w.reach, Reach::full);
  EXPECT_EQ(w.before, 5u);
  EXPECT_EQ(w.middle, 10u);
  EXPECT_EQ(w.after, 10u);
  EXPECT_EQ(w.end, 15u);
  // A fix at the instant itself counts as before it.
  EXPECT_EQ(window_at(seconds(20), 9.0, 5, 2.5).middle, 10u);
  const FixWindow without = window_without(seconds(20), 9, 5, 2.5);
  EXPECT_EQ(without.reach, Reach::full);
  EXPECT_EQ(without.size(), 10u);
  for (size_t k = 0; k < without.size(); ++k) EXPECT_EQ(without.at(k), k < 5 ? 4 + k : 5 + k);
}

TEST(FixWindow, EndsOfTheRecordAreTold) {
  const auto t = seconds(20);
  EXPECT_EQ(window_at(t, -0.1, 5, 2.5).reach, Reach::outside);
  EXPECT_EQ(window_at(t, 0.5, 5, 2.5).reach, Reach::too_few);
  EXPECT_EQ(window_at(t, 1.5, 5, 2.5).reach, Reach::partial);
  EXPECT_EQ(window_at(t, 4.5, 5, 2.5).reach, Reach::full);
  EXPECT_EQ(window_at(t, 15.5, 5, 2.5).reach, Reach::partial);
  EXPECT_EQ(window_at(t, 17.5, 5, 2.5).reach, Reach::partial);
  EXPECT_EQ(window_at(t, 18.5, 5, 2.5).reach, Reach::too_few);
  EXPECT_EQ(window_at(t, 19.5, 5, 2.5).reach, Reach::outside);
  EXPECT_EQ(window_at({}, 0.0, 5, 2.5).reach, Reach::outside);
  EXPECT_EQ(window_without(t, 4, 5, 2.5).reach, Reach::partial);
  EXPECT_EQ(window_without(t, 5, 5, 2.5).reach, Reach::full);
  EXPECT_EQ(window_without(t, 14, 5, 2.5).reach, Reach::full);
  EXPECT_EQ(window_without(t, 15, 5, 2.5).reach, Reach::partial);
}

TEST(FixWindow, GapsAreNeverInsideAWindow) {
  auto t = seconds(30);
  for (size_t i = 15; i < t.size(); ++i) t[i] += 10.0;
  EXPECT_EQ(window_at(t, 20.0, 5, 2.5).reach, Reach::gap);
  const FixWindow before = window_at(t, 12.5, 5, 2.5);
  EXPECT_EQ(before.reach, Reach::partial);
  EXPECT_EQ(before.end, 15u);
  EXPECT_EQ(window_at(t, 13.5, 5, 2.5).reach, Reach::too_few);
  const FixWindow after = window_at(t, 26.5, 5, 2.5);
  EXPECT_EQ(after.reach, Reach::partial);
  EXPECT_EQ(after.before, 15u);
  // One fix missing is no gap, two are.
  t = seconds(30);
  t.erase(t.begin() + 15);
  EXPECT_EQ(window_at(t, 15.0, 5, 2.5).reach, Reach::full);
  EXPECT_EQ(window_without(t, 15, 5, 2.5).reach, Reach::gap);
  t.erase(t.begin() + 15);
  EXPECT_EQ(window_at(t, 15.5, 5, 2.5).reach, Reach::gap);
}

TEST(LocalFrame, IsEastNorthUp) {
  const core::Geodetic place{48 * core::degree, 11 * core::degree, 600.0};
  const LocalFrame f = local_frame(core::ecef_of(place));
  core::GnssData gnss;
  const double step = 1e-6;  // rad: 6 m, whose curvature is 3 micrometres
  for (const auto& [dn, de, du] : {std::array{step, 0.0, 0.0}, std::array{0.0, step, 0.0}, std::array{0.0, 0.0, 6.0}}) {
    gnss.time.push_back(0.0);
    gnss.position.push_back(core::ecef_of({place.latitude + dn, place.longitude + de, place.height + du}));
    gnss.covariance.push_back(f.local_R_ecef.transpose() * Eigen::Vector3d(1, 4, 9).asDiagonal() * f.local_R_ecef);
  }
  const PointFixes fixes = to_local(gnss, f);
  constexpr double curvature = 1e-5;
  EXPECT_LT((fixes.position[0] - Eigen::Vector3d(0, step * (core::meridian_radius(place.latitude) + 600.0), 0)).norm(), curvature);
  EXPECT_LT(
      (fixes.position[1] - Eigen::Vector3d(step * (core::prime_vertical_radius(place.latitude) + 600.0) * std::cos(place.latitude), 0, 0))
          .norm(),
      curvature);
  EXPECT_LT((fixes.position[2] - Eigen::Vector3d(0, 0, 6)).norm(), 1e-8);
  EXPECT_LT((fixes.covariance[0] - Eigen::Matrix3d(Eigen::Vector3d(1, 4, 9).asDiagonal())).norm(), 1e-12);
  EXPECT_LT((f.to_ecef(fixes.position[1]) - gnss.position[1]).norm(), 1e-8);
}

TEST(PolynomialFit, FindsThePolynomialItself) {
  PointFixes fixes = test::MadeFlight(1).fixes(11, 1.0);
  const Eigen::Vector3d p(330000, 7000000, 1700), v(60, -20, 0.5), a(0.3, 0.1, -0.2);
  const auto truth = [&](double t) -> Eigen::Vector3d { return p + t * v + t * t * a; };
  for (size_t i = 0; i < fixes.size(); ++i) fixes.position[i] = truth(fixes.time[i]);
  const FixWindow w = window_at(fixes.time, 5.4, 5, 2.5);
  for (const bool axis : {false, true})
    for (const bool weighted : {false, true}) {
      const PolynomialFit fit = fit_polynomial(fixes, w, 2, axis, weighted);
      EXPECT_LT((fit.position(5.4) - truth(5.4)).norm(), 10 * rounding);
      EXPECT_LT((fit.velocity(5.4) - (v + 2 * 5.4 * a)).norm(), 10 * rounding);
      EXPECT_LT(fit.variance_factor.maxCoeff(), 1e-9);
      EXPECT_GT(fit_polynomial(fixes, w, 1, axis, weighted).variance_factor.minCoeff(), 1.0);
    }
}

TEST(PolynomialFit, CovarianceIsThatOfItsErrors) {
  // Straight lines through noise, many times.
  constexpr int runs = 4000;
  constexpr double tolerance = 0.08;  // of a variance from 4000 draws: its sigma is 2.2 %
  std::mt19937_64 seeds(5);
  for (const bool weighted : {false, true}) {
    Vector6 sum = Vector6::Zero();
    Eigen::Vector3d factor = Eigen::Vector3d::Zero();
    Eigen::Matrix<double, 6, 6> stated;
    for (int k = 0; k < runs; ++k) {
      test::MadeFlight flight(seeds(), 0.0);
      PointFixes fixes = flight.fixes(10, 1.0);
      for (size_t i = 0; i < fixes.size(); ++i) {
        // The second half four times less certain, so that weights matter; times without error.
        const Eigen::Vector3d error = fixes.position[i] - flight.position(static_cast<double>(i));
        const double less = i < 5 ? 1.0 : 4.0;
        fixes.position[i] = less * error;
        fixes.covariance[i] *= less * less;
        fixes.time[i] = static_cast<double>(i);
      }
      const PolynomialFit fit = fit_polynomial(fixes, window_at(fixes.time, 4.5, 5, 2.5), 1, false, weighted);
      Eigen::Matrix<double, 6, 1> e;
      e << fit.position(4.5), fit.velocity(4.5);
      stated = fit.covariance_at(4.5);
      sum += e.cwiseAbs2() / runs;
      factor += fit.variance_factor / runs;
    }
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(sum[k] / stated(k, k), 1.0, tolerance) << weighted << k;
    if (weighted) {
      EXPECT_NEAR(factor[0], 1.0, tolerance);
    }
  }
}

TEST(PolynomialFit, AxesApartIgnoreTheirCovariances) {
  PointFixes fixes = test::MadeFlight(2).fixes(10, 1.0);
  const FixWindow w = window_at(fixes.time, 4.5, 5, 2.5);
  const PolynomialFit apart = fit_polynomial(fixes, w, 1, true, true);
  for (Eigen::Matrix3d& c : fixes.covariance) c = Eigen::Matrix3d(c.diagonal().asDiagonal());
  const PolynomialFit diagonal = fit_polynomial(fixes, w, 1, false, true);
  EXPECT_LT((apart.position(4.5) - diagonal.position(4.5)).norm(), rounding);
  EXPECT_LT((apart.covariance - diagonal.covariance).norm(), 1e-12);
}

}  // namespace
}  // namespace swath::trajectory
