// SPDX-License-Identifier: GPL-3.0-or-later
// A whole run of the smoother over a made flight or drive, and how far it was from the truth.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <string>

#include "core/config/result_visitors.h"
#include "core/error.h"
#include "tests/world/navigation.h"
#include "trajectory/ins/ins_gnss.h"

namespace swath::trajectory::test {

using namespace swath::test;

/// Two lines and the turns about them: 240 s at 100 Hz.
struct Course {
  MotionAt motion;
  Sensors sensors{.from = 0, .until = 240, .imu_step = 0.01};
  Records exact;

  Course(MotionAt m, double from, double until) : motion(std::move(m)) {
    sensors.from = from;
    sensors.until = until;
    exact = exact_records(motion, sensors);
  }
};
inline const Course& lines_and_turns() {
  static const Course course(motion_of(survey_flight(3)), 0, 240);
  return course;
}
inline const Course& straight_line() {
  static const Course course(motion_of(straight_flight(6000)), 0, 120);
  return course;
}

/// One run. What is not set is right and clean.
struct Trial {
  core::ImuGrade grade = core::ImuGrade::tactical;
  std::uint64_t seed = 1;
  FixErrors fixes;
  InsGnssOptions options;
  core::ImuErrorModel stated = core::error_model_of(grade);
  Eigen::Vector3d lever_off = Eigen::Vector3d::Zero();  ///< stated minus true
  double lever_sigma = 0.02;
  std::function<void(core::ImuData&)> change_imu;
  std::function<void(core::GnssData&)> change_gnss;

  InsGnssResult on(const Course& course) const {
    core::ImuData imu = with_errors(course.exact.imu, core::error_model_of(grade), seed);
    core::GnssData gnss = with_errors(course.exact.gnss, fixes, seed);
    if (change_imu) change_imu(imu);
    if (change_gnss) change_gnss(gnss);
    return smooth(imu, gnss, stated, course.sensors.lever + lever_off, lever_sigma, options);
  }
};

inline Trial trial_of(core::ImuGrade grade, std::uint64_t seed = 1) {
  Trial r;
  r.grade = grade;
  r.stated = core::error_model_of(grade);
  r.seed = seed;
  return r;
}

/// Sums of squares over records, every 0.2 s or so.
struct Statistics {
  Error6 squares = Error6::Zero(), normed = Error6::Zero();
  double count = 0, nees = 0, largest = 0;

  void add(const InsGnssResult& r, const Course& course, double from = -1e9, double until = 1e9, size_t every = 20) {
    const core::TrajectoryData& d = r.trajectory;
    for (size_t k = 0; k < d.size(); k += every) {
      if (d.time[k] < motion_start + from || d.time[k] > motion_start + until) continue;
      const Error6 e = error_of(d, k, course.motion);
      squares += e.cwiseAbs2();
      normed += e.cwiseQuotient(sigma_of(d, k)).cwiseAbs2();
      largest = std::max(largest, e.head<3>().norm());
      const auto c = d.covariance.at(d.time[k]);
      Eigen::Matrix<double, 6, 6> c6;
      c6 << c.block<3, 3>(0, 0), c.block<3, 3>(0, 6), c.block<3, 3>(6, 0), c.block<3, 3>(6, 6);
      nees += e.dot(c6.llt().solve(e));
      ++count;
    }
  }
  Error6 rms() const { return (squares / count).cwiseSqrt(); }
  Error6 by_sigma() const { return (normed / count).cwiseSqrt(); }
  void print(const char* what) const {
    const Error6 r = rms(), s = by_sigma();
    std::printf("%s: rms %.4f %.4f %.4f m, %.2f %.2f %.2f arcsec; by sigma %.2f %.2f %.2f %.2f %.2f %.2f; nees/6 %.2f; largest %.3f m\n",
                what, r[0], r[1], r[2], r[3] * 206265, r[4] * 206265, r[5] * 206265, s[0], s[1], s[2], s[3], s[4], s[5], nees / count / 6,
                largest);
  }
};

/// The first warning that holds the text, or "".
inline std::string warning_with(const InsGnssResult& r, const std::string& part) {
  for (const NamedFault& n : r.report.figures.named)
    if (n.sentence.find(part) != std::string::npos) return n.sentence;
  for (const std::string& w : r.report.warnings)
    if (w.find(part) != std::string::npos) return w;
  return "";
}
inline double number(const InsGnssResult& r, const char* group, const char* name) {
  return core::reported(r.report).find(group)->find(name)->as_number();
}

/// The text of the error that a run ends with; "" where it ends well.
inline std::string error_of_run(const Trial& run, const Course& course) {
  try {
    run.on(course);
  } catch (const core::Error& e) {
    return e.text();
  }
  return "";
}

}  // namespace swath::trajectory::test
