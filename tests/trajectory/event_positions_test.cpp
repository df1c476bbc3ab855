// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/event_positions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/geo/geodesy.h"
#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

/// A made flight somewhere on Earth. Its axes are those of the start: a straight line there rises above the ellipsoid on the way.
struct OnEarth {
  test::MadeFlight flight{1};
  LocalFrame frame = local_frame(core::ecef_of({-25.4 * core::degree, -49.2 * core::degree, 1800.0}));
  core::GnssData gnss;

  explicit OnEarth(size_t n) {
    const PointFixes fixes = flight.fixes(n, 1.0);
    for (size_t i = 0; i < n; ++i) {
      gnss.time.push_back(1.4e9 + fixes.time[i]);
      gnss.position.push_back(frame.to_ecef(fixes.position[i]));
      gnss.covariance.push_back(frame.local_R_ecef.transpose() * fixes.covariance[i] * frame.local_R_ecef);
    }
  }
  Eigen::Vector3d truth(double t) const { return frame.to_ecef(flight.position(t - 1.4e9)); }
  Eigen::Vector3d velocity(double t) const {
    return local_frame(truth(t)).local_R_ecef * frame.local_R_ecef.transpose() * flight.velocity(t - 1.4e9);
  }
};

TEST(EventPositions, LieOnTheFlightWithTheirVelocity) {
  const OnEarth made(1200);
  std::vector<double> times;
  for (double s = 6.3; s < 1190; s += 2.7) times.push_back(1.4e9 + s);
  for (const Interpolator method : {Interpolator::kalman, Interpolator::rts}) {
    const std::vector<EventPosition> events = positions_at(track_of(made.gnss, {}, {}), made.gnss.position.front(), times, method, {});
    ASSERT_EQ(events.size(), times.size());
    std::vector<Difference> errors, velocity_errors;
    for (size_t k = 0; k < times.size(); ++k) {
      const EventPosition& e = events[k];
      ASSERT_EQ(e.reach, Reach::full);
      EXPECT_EQ(e.fixes, 10u);
      errors.push_back({local_frame(e.position).local_R_ecef * (e.position - made.truth(times[k])), e.sigma, e.sigma});
      velocity_errors.push_back({e.velocity - made.velocity(times[k]), e.velocity_sigma, e.velocity_sigma});
      EXPECT_EQ(e.sigma[2], std::sqrt(e.covariance(2, 2)));
      EXPECT_EQ(e.velocity_sigma[0], std::sqrt(e.covariance(3, 3)));
    }
    const DifferenceStatistics s = statistics_of(errors), velocity = statistics_of(velocity_errors);
    // The fixes' own 1.6, 2.4, 4 cm and 3 cm of their clock; turbulence between them.
    EXPECT_LT(s.rms.maxCoeff(), 0.06);
    EXPECT_LT(s.mean.cwiseAbs().maxCoeff(), 0.01);
    EXPECT_LT(velocity.rms.maxCoeff(), 0.12);
    // A clock error of 3 cm along the path, mostly east, is not in the fixes' sigmas.
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(s.ratio[k], 1.0, 0.35) << k;
      EXPECT_NEAR(velocity.ratio[k], 1.0, 0.35) << k;
    }
  }
}

TEST(EventPositions, TheComparisonsAreWorse) {
  const OnEarth made(300);
  std::vector<double> times;
  for (double s = 6.3; s < 290; s += 0.9) times.push_back(1.4e9 + s);
  double rms[interpolators.size()];
  for (const Interpolator method : interpolators) {
    const std::vector<EventPosition> events = positions_at(track_of(made.gnss, {}, {}), made.gnss.position.front(), times, method, {});
    double square = 0.0;
    for (size_t k = 0; k < times.size(); ++k) square += (events[k].position - made.truth(times[k])).squaredNorm();
    rms[static_cast<size_t>(method)] = std::sqrt(square);
  }
  const auto of = [&](Interpolator i) { return rms[static_cast<size_t>(i)]; };
  EXPECT_GT(of(Interpolator::line), 10.0 * of(Interpolator::kalman));
  EXPECT_GT(of(Interpolator::parabola), 2.0 * of(Interpolator::kalman));
  EXPECT_LT(of(Interpolator::rts), of(Interpolator::kalman));
}

TEST(EventPositions, NothingIsExtrapolated) {
  OnEarth made(60);
  const auto drop = [](auto& column) { column.erase(column.begin() + 20, column.begin() + 30); };
  drop(made.gnss.time), drop(made.gnss.position), drop(made.gnss.covariance);
  const std::vector<double> seconds{-1.0, 0.5, 2.5, 10.5, 17.5, 18.5, 25.0, 32.5, 45.0, 58.5, 70.0};
  const Reach expected[] = {Reach::outside, Reach::too_few, Reach::partial, Reach::full,    Reach::partial, Reach::too_few,
                            Reach::gap,     Reach::partial, Reach::full,    Reach::too_few, Reach::outside};
  std::vector<double> times;
  for (const double s : seconds) times.push_back(1.4e9 + s);
  const std::vector<EventPosition> events =
      positions_at(track_of(made.gnss, {}, {}), made.gnss.position.front(), times, Interpolator::kalman, {});
  for (size_t k = 0; k < times.size(); ++k) {
    EXPECT_EQ(events[k].reach, expected[k]) << seconds[k];
    EXPECT_EQ(events[k].position.allFinite(), reached(expected[k]));
    EXPECT_EQ(events[k].sigma.allFinite(), reached(expected[k]));
  }
}

TEST(EventPositions, FixesOfNoUseAreKnown) {
  OnEarth made(6);
  made.gnss.position[1].x() = std::numeric_limits<double>::quiet_NaN();
  made.gnss.covariance[2].setZero();
  made.gnss.covariance[3](0, 0) = -1.0;
  made.gnss.time[4] = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(usable(made.gnss, i), i == 0 || i == 5) << i;
}

}  // namespace
}  // namespace swath::trajectory
