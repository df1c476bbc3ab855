// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/calibration_views.h"

#include <gtest/gtest.h>

#include "core/geo/geodesy.h"
#include "tests/calib/tie_world.h"

namespace swath::stages {
namespace {

namespace made = calib::test;

/// Hands on the shots of a made flight.
class MadeSource : public Stage {
 public:
  explicit MadeSource(const made::Flown& flown) : flown_(flown) {}
  const Info& info() const override {
    static const Info info{"made", "", {Grain::strip}, {}, {}, {}, {Product::shots}};
    return info;
  }
  void visit(core::Visitor&) override {}
  std::unique_ptr<StripReader> open(const Context&, const Strip& s) const override {
    class Reader : public StripReader {
     public:
      explicit Reader(const core::Shots& shots) : shots_(shots) {}
      bool next(StripBatch& batch, size_t, core::Tally&) override {
        if (done_) return false;
        batch.shots = shots_;
        return done_ = true;
      }

     private:
      const core::Shots& shots_;
      bool done_ = false;
    };
    return std::make_unique<Reader>(flown_.lines[s.index].second);
  }

 private:
  const made::Flown& flown_;
};

TEST(CalibrationViews, DifferencesSectionsAndChecksBeforeAndAfter) {
  made::TieWorld world;
  world.houses = {made::gable({0, 0}, 0.4, 14, 8, 0.0, 5, 9)};
  world.range_noise = 0.01;
  world.prf = 40000;
  world.truth.roll = core::degrees(0.1);
  const made::Flown flown = made::fly(world, {{{0, 0}, 400, 0.3, 200}, {{0, 0}, 400, 0.3 + core::pi, 200}}, 1);
  const trajectory::Trajectory trajectory(flown.data);
  const MadeSource source(flown);
  io::Survey survey;
  survey.crs = "EPSG:32632";
  Context context{survey};
  context.crs = core::Crs(survey.crs);
  context.source = &source;
  for (size_t k = 0; k < flown.lines.size(); ++k) context.strips.push_back({0, k, flown.lines[k].first, "", 0});
  core::Transform to_map(core::wgs84_ecef(), context.crs);
  context.origin = to_map(world.frame.origin).array().round();

  calib::TieSet ties;
  ties.frame = world.frame;
  calib::TiePlane roof;
  roof.centre = {1.5, 4, 7};
  const Eigen::Vector2d down(-std::sin(0.4), std::cos(0.4));
  roof.normal = Eigen::Vector3d(0.5 * down.x(), 0.5 * down.y(), 1).normalized();
  roof.half = {12, 4};
  roof.kind = calib::TieKind::roof;
  ties.planes = {roof};
  ties.groups = {{0, 0, 0, 0}, {0, 1, 0, 0}};
  calib::SurveyedTarget point;
  point.name = "peg";
  point.is_point = true;
  point.centre = {40, 10, -0.03};
  point.control = {{point.centre, 0.01, "peg"}};
  point.use = io::ControlUse::check;
  calib::SurveyedTarget used = point;
  used.use = io::ControlUse::control;

  const core::Calibration nominal;
  const CalibrationViews views =
      view_calibration(context, {&nominal, &trajectory}, {&world.truth, &trajectory}, ties, {point, used}, {}, 2.0, 3);
  ASSERT_EQ(views.before.size(), 1u);
  ASSERT_EQ(views.after.size(), 1u);
  // Roll 0.1 deg turns the two lines against one another by 0.2 deg: up to 0.5 m at 145 m from the nadir.
  EXPECT_GT(views.before[0].statistics.rms, 0.1);
  EXPECT_LT(views.after[0].statistics.rms, 0.02) << "means of some ten returns of 1 cm each";
  ASSERT_EQ(views.sections.size(), 1u);
  EXPECT_EQ(views.sections_after[0].size(), 2u) << "both lines";
  ASSERT_EQ(views.checks.size(), 1u) << "control is no check";
  EXPECT_NEAR(views.checks[0].difference, 0.03, 4 * 0.01 / std::sqrt(10));
}

}  // namespace
}  // namespace swath::stages
