// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/kinematic.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "io/text/value_file.h"
#include "tests/trajectory/kinematic_vectors.h"
#include "tests/trajectory/made_flight.h"

namespace swath::trajectory {
namespace {

constexpr double position_tolerance = 1e-6;    // m, of the reference's statement
constexpr double velocity_tolerance = 1e-6;    // m/s
constexpr double covariance_tolerance = 1e-6;  // of sqrt(c_ii c_jj)
constexpr double printed = 0.6e-7;             // the reference prints 7 decimals of a state

struct Worst {
  double position = 0, velocity = 0, covariance = 0, gain = 0;
  void state(const PointState::Vector6& a, const PointState::Vector6& b) {
    position = std::max(position, (a - b).head<3>().cwiseAbs().maxCoeff());
    velocity = std::max(velocity, (a - b).tail<3>().cwiseAbs().maxCoeff());
  }
  void matrix(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    for (int i = 0; i < a.rows(); ++i)
      for (int j = 0; j < a.cols(); ++j) covariance = std::max(covariance, std::abs(a(i, j) - b(i, j)) / std::sqrt(b(i, i) * b(j, j)));
  }
};

void expect_close(const Worst& w, const std::string& what) {
  EXPECT_LT(w.position, position_tolerance + printed) << what;
  EXPECT_LT(w.velocity, velocity_tolerance + printed) << what;
  EXPECT_LT(w.covariance, covariance_tolerance) << what;
}

TEST(Kinematic, EveryVariantOfTheReferenceAtEveryEvent) {
  SWATH_SHARED_OR_SKIP(folder, "vectors/p000_expected.json");
  const core::Value expected = io::read_value_file(folder);
  for (const auto& [name, flight] : expected.find("trajectories")->members()) {
    const PointFixes fixes = test::read_fixes(folder.parent_path() / flight.find("csv")->as_text());
    for (const auto& [variant, stated] : expected.find("variants")->members()) {
      const KinematicOptions options = test::options_of(stated);
      Worst worst;
      for (const core::Value& event : flight.find("events")->items()) {
        const core::Value& e = *event.find("results")->find(variant);
        const double t = event.find("time")->as_number();
        const FixWindow w = window_at(fixes.time, t, 5, longest_step(fixes, options));
        ASSERT_EQ(w.reach, Reach::full);
        KinematicTrace trace;
        const PointState s = interpolate(fixes, w, t, options, &trace);
        PointState::Vector6 x;
        x << test::vector3(*e.find("pos")), test::vector3(*e.find("vel"));
        worst.state(s.x, x);
        EXPECT_LT((trace.noise - test::vector3(*e.find("sigma_w"))).norm(), 1e-9) << variant;
        EXPECT_LT((polynomial_at(fixes, w, t, 1, options).position() - test::vector3(*e.find("line"))).norm(), 1e-6) << variant;
        if (const core::Value* axes = e.find("cov_axis")) {
          for (int k = 0; k < 3; ++k) {
            const core::Value& c = axes->items()[static_cast<size_t>(k)];
            Eigen::Matrix2d ours, theirs;
            ours << s.covariance(k, k), s.covariance(k, k + 3), s.covariance(k + 3, k), s.covariance(k + 3, k + 3);
            for (int i = 0; i < 2; ++i)
              for (int j = 0; j < 2; ++j) theirs(i, j) = c.items()[static_cast<size_t>(i)].items()[static_cast<size_t>(j)].as_number();
            worst.matrix(ours, theirs);
          }
        } else {
          worst.matrix(s.covariance, test::matrix6(*e.find("cov6_x_vx_y_vy_z_vz")));
        }
      }
      expect_close(worst, name + " " + variant);
    }
  }
}

TEST(Kinematic, EveryPredictionAndUpdateOfTheReference) {
  SWATH_SHARED_OR_SKIP(folder, "vectors/p000_trace.json");
  const PointFixes fixes = test::read_fixes(folder.parent_path() / "p000_traj1.csv");
  const core::Value file = io::read_value_file(folder);
  int compared = 0;
  for (const auto& [variant, stated] : file.members()) {
    if (!stated.is_object()) continue;
    const KinematicOptions options = test::options_of(*stated.find("options"));
    const double t = stated.find("event_time")->as_number();
    const FixWindow w = window_at(fixes.time, t, 5, longest_step(fixes, options));
    const core::Value::Array& window = stated.find("window_epochs")->items();
    ASSERT_EQ(window.size(), w.size());
    for (size_t k = 0; k < w.size(); ++k) EXPECT_EQ(static_cast<size_t>(window[k].as_int()), w.at(k));
    KinematicTrace trace;
    const PointState s = interpolate(fixes, w, t, options, &trace);
    EXPECT_LT((trace.noise - test::vector3(*stated.find("sigma_w"))).norm(), 1e-9);
    Worst worst;
    worst.state(trace.start_forward.x, test::state6(*stated.find("x0_forward")));
    worst.matrix(trace.start_forward.covariance, test::matrix6(*stated.find("P0_forward")));
    worst.state(trace.start_backward.x, test::state6(*stated.find("x0_backward")));
    worst.matrix(trace.start_backward.covariance, test::matrix6(*stated.find("P0_backward")));
    for (const auto& [direction, steps] : {std::pair{"forward", &trace.forward}, std::pair{"backward", &trace.backward}}) {
      const core::Value::Array& theirs = stated.find(direction)->items();
      ASSERT_EQ(theirs.size(), steps->size());
      for (size_t k = 0; k < theirs.size(); ++k) {
        const KinematicTrace::Step& step = (*steps)[k];
        const char* kind = step.kind == KinematicTrace::Kind::update    ? "update"
                           : step.kind == KinematicTrace::Kind::predict ? "predict"
                                                                        : "predict_to_event";
        EXPECT_EQ(theirs[k].find("step")->as_text(), kind);
        EXPECT_DOUBLE_EQ(theirs[k].find("t")->as_number(), step.state.time);
        worst.state(step.state.x, test::state6(*theirs[k].find("x")));
        worst.matrix(step.state.covariance, test::matrix6(*theirs[k].find("P")));
        if (const core::Value* gain = theirs[k].find("K"))
          for (int i = 0; i < 6; ++i)
            for (int j = 0; j < 3; ++j)
              worst.gain = std::max(
                  worst.gain, std::abs(step.gain(i, j) -
                                       gain->items()[static_cast<size_t>(test::place[i])].items()[static_cast<size_t>(j)].as_number()));
        ++compared;
      }
    }
    worst.state(s.x, test::state6(*stated.find("smoothed")->find("x")));
    worst.matrix(s.covariance, test::matrix6(*stated.find("smoothed")->find("P")));
    expect_close(worst, variant);
    EXPECT_LT(worst.gain, 1e-6) << variant;
  }
  EXPECT_EQ(compared, 3 * 20);
}

PointFixes line_fixes(const Eigen::Vector3d& p, const Eigen::Vector3d& v) {
  PointFixes fixes = test::MadeFlight(3).fixes(12, 1.0);
  for (size_t i = 0; i < fixes.size(); ++i) fixes.position[i] = p + fixes.time[i] * v;
  return fixes;
}

TEST(Kinematic, AStraightFlightWithoutNoiseIsMetInEveryForm) {
  const Eigen::Vector3d p(500, -300, 1200), v(40, 45, -1.5);
  const PointFixes fixes = line_fixes(p, v);
  for (const AxesForm axes : {AxesForm::axis, AxesForm::simultaneous})
    for (const StartCovariance start : {StartCovariance::a_priori, StartCovariance::a_posteriori, StartCovariance::diffuse})
      for (const NoiseSpeed noise : {NoiseSpeed::axis, NoiseSpeed::speed})
        for (const bool first : {false, true}) {
          KinematicOptions o;
          o.axes = axes;
          o.start_covariance = start;
          o.noise = noise;
          o.update_first = first;
          const PointState s = interpolate(fixes, window_at(fixes.time, 5.3, 5, 2.5), 5.3, o);
          // Through P of 1e6 beside R of 1e-4 a state keeps 1e-16 * 1e10 of its correction.
          constexpr double tolerance = 1e-7;
          EXPECT_LT((s.position() - (p + 5.3 * v)).norm(), tolerance);
          EXPECT_LT((s.velocity() - v).norm(), tolerance);
          EXPECT_GT(s.covariance.diagonal().minCoeff(), 0.0);
        }
}

TEST(Kinematic, NoiseIsAShareOfTheSpeedAndNotBelowTheFloor) {
  const PointFixes fixes = line_fixes({0, 0, 0}, {30, -40, 0.5});
  const FixWindow w = window_at(fixes.time, 5.3, 5, 2.5);
  KinematicOptions o;
  KinematicTrace trace;
  const auto noise = [&] {
    interpolate(fixes, w, 5.3, o, &trace);
    return trace.noise;
  };
  constexpr double tolerance = 1e-9;
  EXPECT_LT((noise() - Eigen::Vector3d::Constant(0.01 * std::sqrt(2500.25))).norm(), tolerance);
  o.noise = NoiseSpeed::axis;
  EXPECT_LT((noise() - Eigen::Vector3d(0.3, 0.4, 0.05)).norm(), tolerance);
  o.noise_floor = core::MetresPerSecond(0.0);
  EXPECT_LT((noise() - Eigen::Vector3d(0.3, 0.4, 0.005)).norm(), tolerance);
  o.noise_share = 0.1;
  EXPECT_LT((noise() - Eigen::Vector3d(3.0, 4.0, 0.05)).norm(), tolerance);
}

TEST(Kinematic, NoiseThatGrowsWithTimeDoesNotCountStepsButSeconds) {
  // Velocity's variance after the event's own short step: by time it grows by that share of a second, else by a whole step.
  const PointFixes fixes = line_fixes({0, 0, 0}, {60, 0, 0});
  const FixWindow w = window_at(fixes.time, 5.2, 5, 2.5);
  KinematicOptions o;
  KinematicTrace trace;
  for (const bool grows : {true, false}) {
    o.noise_grows_with_time = grows;
    interpolate(fixes, w, 5.2, o, &trace);
    const auto last = trace.forward.end() - 1, before = trace.forward.end() - 2;
    const double grown = last->state.covariance(3, 3) - before->state.covariance(3, 3);
    const double share = grows ? last->state.time - before->state.time : 1.0;
    EXPECT_NEAR(grown, 0.36 * share, 1e-9);
  }
}

TEST(Kinematic, TimeBackwardsIsTheSameFlightBackwards) {
  const PointFixes fixes = test::MadeFlight(4).fixes(12, 1.0);
  PointFixes mirrored;
  for (size_t i = fixes.size(); i-- > 0;) {
    mirrored.time.push_back(-fixes.time[i]);
    mirrored.position.push_back(fixes.position[i]);
    mirrored.covariance.push_back(fixes.covariance[i]);
  }
  const KinematicOptions o;
  const double t = 5.4;
  const PointState a = interpolate(fixes, window_at(fixes.time, t, 5, 2.5), t, o);
  const PointState b = interpolate(mirrored, window_at(mirrored.time, -t, 5, 2.5), -t, o);
  EXPECT_LT((a.position() - b.position()).norm(), 1e-7);
  EXPECT_LT((a.velocity() + b.velocity()).norm(), 1e-7);
}

TEST(Kinematic, PredictionCarriesTheCovarianceByItsJacobian) {
  test::MadeFlight random(7);
  PointState s;
  PointState::Matrix6 root;
  for (int i = 0; i < 6; ++i) s.x[i] = random.normal();
  for (int i = 0; i < 36; ++i) root.data()[i] = random.normal();
  s.covariance = root * root.transpose();
  for (const double dt : {0.0, 0.3, 1.0, -2.0}) {
    PointState::Matrix6 jacobian;
    constexpr double h = 1e-3;  // the prediction is linear: any step will do
    for (int i = 0; i < 6; ++i) {
      PointState above = s, below = s;
      above.x[i] += h;
      below.x[i] -= h;
      jacobian.col(i) = (predict(above, dt, PointState::Matrix6::Zero()).x - predict(below, dt, PointState::Matrix6::Zero()).x) / (2 * h);
    }
    const PointState::Matrix6 q = PointState::Matrix6::Identity();
    EXPECT_LT((predict(s, dt, q).covariance - jacobian * s.covariance * jacobian.transpose() - q).norm(), 1e-9) << dt;
  }
}

TEST(Kinematic, UpdateAndFusionAddInformation) {
  test::MadeFlight random(8);
  const auto state = [&] {
    PointState s;
    PointState::Matrix6 root;
    for (int i = 0; i < 6; ++i) s.x[i] = random.normal();
    for (int i = 0; i < 36; ++i) root.data()[i] = random.normal();
    s.covariance = root * root.transpose() + PointState::Matrix6::Identity();
    return s;
  };
  constexpr double tolerance = 1e-10;
  const PointState a = state(), b = state();
  const PointState::Matrix6 ia = a.covariance.inverse(), ib = b.covariance.inverse();
  const PointState f = fuse(a, b);
  EXPECT_LT((f.covariance.inverse() - (ia + ib)).norm(), tolerance * (ia + ib).norm() * 100);
  EXPECT_LT((f.x - f.covariance * (ia * a.x + ib * b.x)).norm(), tolerance);

  const Eigen::Matrix3d r = state().covariance.topLeftCorner<3, 3>();
  const Eigen::Vector3d z(1, 2, 3);
  const PointState u = update(a, z, r);
  PointState::Matrix6 information = ia;
  information.topLeftCorner<3, 3>() += r.inverse();
  PointState::Vector6 right = ia * a.x;
  right.head<3>() += r.inverse() * z;
  EXPECT_LT((u.covariance * information - PointState::Matrix6::Identity()).norm(), tolerance * 100);
  EXPECT_LT((u.x - u.covariance * right).norm(), tolerance * 100);
}

}  // namespace
}  // namespace swath::trajectory
