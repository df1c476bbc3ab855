// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/ties/local_points.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/calib/survey_support.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double start = 1.4e9;

trajectory::LocalFrame some_frame() { return trajectory::local_frame(core::ecef_of({47.897 * test::deg, 10.5 * test::deg, 650.0})); }

core::Shots shots_of(core::ScannerModel model, size_t n) {
  core::Shots shots = test::zigzag(n, start + 1.0, 20000.0, 950.0);
  if (model == core::ScannerModel::conical || model == core::ScannerModel::palmer)
    for (size_t i = 0; i < n; ++i) shots.angle[i] = 0.01 * static_cast<double>(i);
  if (model == core::ScannerModel::beam)
    for (size_t i = 0; i < n; ++i) shots.forward.push_back(0.1 * std::sin(0.001 * static_cast<double>(i)));
  return shots;
}

TEST(LocalPoints, AgreeWithTheSingleReturn) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const trajectory::LocalFrame frame = some_frame();
  constexpr double tolerance = 1e-5;  // m, as the header says
  for (const core::ScannerModel model : test::all_models)
    for (const bool air : {false, true}) {
      const ShotGeometry single(test::scanner_of(model, air), test::some_calibration());
      LocalPoints points(test::scanner_of(model, air), test::some_calibration(), flight, frame);
      const core::Shots shots = shots_of(model, 3000);
      PointColumns p;
      points.run(shots, p);
      ASSERT_EQ(p.x.size(), shots.size());
      for (size_t i = 0; i < shots.size(); i += 7) {
        const Return r{shots.angle[i], shots.forward.empty() ? 0.0 : shots.forward[i], shots.range[i]};
        const Vector3d ecef = single.ecef_point(*flight.pose_at(single.time(shots.time[i])), r);
        const Vector3d local = frame.local_R_ecef * (ecef - frame.origin);
        ASSERT_LT((Vector3d(p.x[i], p.y[i], p.z[i]) - local).norm(), tolerance) << "model " << static_cast<int>(model) << " return " << i;
      }
    }
}

TEST(LocalPoints, ReturnsWithoutAPlaceAreNotNumbers) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  LocalPoints points({}, {}, flight, some_frame());
  core::Shots shots = test::zigzag(6, start + 1.0, 20000.0, 950.0);
  shots.range[0] = -1.0;
  shots.range[1] = std::numeric_limits<double>::quiet_NaN();
  shots.time[2] = start + 100.0;
  shots.angle[3] = std::numeric_limits<double>::infinity();
  shots.forward = {0, 0, 0, 0, 1.5, 0};
  PointColumns p;
  points.run(shots, p);
  for (size_t i = 0; i < 5; ++i) EXPECT_TRUE(std::isnan(p.x[i])) << i;
  EXPECT_FALSE(std::isnan(p.x[5]));
}

TEST(LocalPoints, MovementByBoresightAgreesWithDifferences) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const core::Calibration calibration = test::some_calibration();
  const core::Shots shots = shots_of(core::ScannerModel::mirror, 40);
  LocalPoints points({}, calibration, flight, some_frame());
  constexpr double step = 1e-5, tolerance = 1e-4;  // rad; m/rad of 1000: the second difference
  for (size_t i = 0; i < shots.size(); i += 13) {
    const auto by = points.by_boresight(shots.time[i], {shots.angle[i], 0.0, shots.range[i]});
    ASSERT_TRUE(by);
    for (int k = 0; k < 3; ++k) {
      Vector3d at[2];
      for (int side = 0; side < 2; ++side) {
        core::Calibration c = calibration;
        (k == 0 ? c.roll : k == 1 ? c.pitch : c.heading).value += side ? step : -step;
        PointColumns p;
        LocalPoints({}, c, flight, some_frame()).run(shots, p);
        at[side] = {p.x[i], p.y[i], p.z[i]};
      }
      EXPECT_LT((by->col(k) - (at[1] - at[0]) / (2 * step)).norm(), tolerance) << k;
    }
  }
  EXPECT_FALSE(points.by_boresight(start + 100.0, {0.0, 0.0, 900.0}));
  const auto place = points.place_at(shots.time[0]);
  ASSERT_TRUE(place);
  EXPECT_NEAR(place->scanner.z(), 950.0, 10.0);  // flown at 1600 m over a frame at 650 m
  EXPECT_NEAR((place->local_R_body * Vector3d::UnitZ()).z(), -1.0, 0.01);
}

TEST(LocalPoints, DensityIsToldBeforeTheFirstBatchWhateverTheBatches) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  const core::Shots all = test::zigzag(60000, start + 1.0, 20000.0, 950.0);
  double told[2] = {};
  int run = 0;
  for (const size_t batch : {700u, 60000u}) {
    const ShotStream stream = [&](const std::function<void(int, const core::Shots&)>& f) {
      for (size_t first = 0; first < all.size(); first += batch) {
        core::Shots part;
        const size_t end = std::min(first + batch, all.size());
        core::for_each_column(part, all, [&](auto& to, const auto& from) {
          if (!from.empty()) to.assign(from.begin() + static_cast<long>(first), from.begin() + static_cast<long>(end));
        });
        f(1, part);
      }
    };
    LocalPoints points({}, {}, flight, some_frame());
    size_t seen = 0;
    stream_points(
        stream, points,
        [&](double d) {
          told[run] = d;
          EXPECT_EQ(seen, 0u);
        },
        [&](int, const core::Shots& s, const PointColumns& p) {
          seen += s.size();
          EXPECT_EQ(p.x.size(), s.size());
        });
    EXPECT_EQ(seen, all.size());
    ++run;
  }
  EXPECT_EQ(told[0], told[1]);
  // 20 kHz, 60 m/s, 690 m of swath; the cells at its rim are not full.
  EXPECT_NEAR(told[0], 20000.0 / (60.0 * 690.0), 0.15);
}

TEST(LocalPoints, AStreamWithoutPointsHasNoDensity) {
  const trajectory::Trajectory flight(test::curved_flight(start, 1600.0));
  LocalPoints points({}, {}, flight, some_frame());
  double told = 1.0;
  stream_points([](const auto&) {}, points, [&](double d) { told = d; }, [](int, const core::Shots&, const PointColumns&) { FAIL(); });
  EXPECT_TRUE(std::isnan(told));
}

TEST(LocalPoints, LastReturnsAreThoseThatMayLieOnASurface) {
  core::Shots s;
  s.time = {0, 1, 2, 3};
  EXPECT_TRUE(is_last_return(s, 0)) << "nothing known";
  s.return_number = {1, 1, 2, 0};
  s.return_count = {1, 2, 2, 0};
  EXPECT_TRUE(is_last_return(s, 0));
  EXPECT_FALSE(is_last_return(s, 1));
  EXPECT_TRUE(is_last_return(s, 2));
  EXPECT_TRUE(is_last_return(s, 3));
}

}  // namespace
}  // namespace swath::calib
