// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/ins_gnss.h"

#include <gtest/gtest.h>

#include <chrono>

#include "core/error.h"
#include "tests/world/navigation.h"

namespace swath::trajectory {
namespace {
using core::ImuGrade;
TEST(Explore, Seeds) {
  const auto flight = test::survey_flight(4);
  std::printf("duration %.1f lines:", flight.duration());
  for (const auto& l : flight.lines()) std::printf(" %.0f-%.0f", l.start, l.end);
  std::printf("\n");
  const test::MotionAt motion = test::motion_of(flight);
  for (const double step : {0.005, 0.01}) {
    const test::Records exact = test::exact_records(motion, {.from = 0, .until = flight.duration(), .imu_step = step});
    for (const ImuGrade grade : {ImuGrade::navigation, ImuGrade::tactical, ImuGrade::mems}) {
      const core::ImuErrorModel model = core::error_model_of(grade);
      test::Error6 squares = test::Error6::Zero(), normed = test::Error6::Zero();
      double n = 0, nis = 0;
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const auto start = std::chrono::steady_clock::now();
        const InsGnssResult r = smooth(test::with_errors(exact.imu, model, seed), test::with_errors(exact.gnss, {}, seed), model,
                                       test::Sensors().lever, 0.02);
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        nis += r.report.find("innovations")->find("mean_nis")->as_number() / 4;
        for (size_t k = 0; k < r.trajectory.size(); k += 20) {
          const test::Error6 e = test::error_of(r.trajectory, k, motion);
          squares += e.cwiseAbs2();
          normed += e.cwiseQuotient(test::sigma_of(r.trajectory, k)).cwiseAbs2();
          ++n;
        }
        std::printf("seed %d %.2f s, %d iterations, %s; ", int(seed), s, int(r.report.find("span")->find("iterations")->as_int()), r.report.find("alignment")->find("method")->as_text().c_str());
        for (const auto& w : r.report.find("warnings")->items()) std::printf("\n  W %s", w.as_text().c_str());
      }
      std::printf("\ngrade %d: rms", int(grade));
      for (int i = 0; i < 3; ++i) std::printf(" %.4f", std::sqrt(squares[i] / n));
      for (int i = 3; i < 6; ++i) std::printf(" %.2f", std::sqrt(squares[i] / n) * 206265);
      std::printf(" e/s");
      for (int i = 0; i < 6; ++i) std::printf(" %.2f", std::sqrt(normed[i] / n));
      std::printf(" nis %.2f\n", nis);
    }
  }
}
}  // namespace
}  // namespace swath::trajectory
