// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/kinematic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "io/value_file.h"
#include "tests/trajectory/kinematic_vectors.h"

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
      RecordProperty(name + " " + variant + " position", std::to_string(worst.position * 1e9) + " nm");
      printf("%s %s %.3g %.3g %.3g\n", name.c_str(), variant.c_str(), worst.position, worst.velocity, worst.covariance);
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
    for (const auto& [direction, steps] :
         {std::pair{"forward", &trace.forward}, std::pair{"backward", &trace.backward}}) {
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
      printf("%s %.3g %.3g %.3g %.3g\n", variant.c_str(), worst.position, worst.velocity, worst.covariance, worst.gain);
    expect_close(worst, variant);
    EXPECT_LT(worst.gain, 1e-6) << variant;
  }
  EXPECT_EQ(compared, 3 * 20);
}

}  // namespace
}  // namespace swath::trajectory
