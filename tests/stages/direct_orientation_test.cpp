// SPDX-License-Identifier: GPL-3.0-or-later
// The stage orientation.direct, run on its own.
#include <gtest/gtest.h>

#include <cmath>

#include "core/geo/geodesy.h"
#include "io/text/text_table.h"
#include "tests/stages/tile_work.h"

namespace swath::stages {
namespace {

constexpr double latitude = 48.0 * core::degree, longitude = 9.0 * core::degree, height = 900.0;  // on the map's central meridian

/// North at 50 m/s, level, 20 Hz.
core::TrajectoryData northward() {
  core::TrajectoryData d;
  for (int k = 0; k < 200; ++k) {
    d.time.push_back(1000.0 + 0.05 * k);
    d.latitude.push_back(latitude + 2.5 * k / core::meridian_radius(latitude));
    d.longitude.push_back(longitude), d.height.push_back(height);
    d.roll.push_back(0.0), d.pitch.push_back(0.0), d.heading.push_back(0.0);
    d.sigma_north.push_back(0.02F), d.sigma_east.push_back(0.03F), d.sigma_down.push_back(0.05F);
    d.sigma_roll.push_back(1e-4F), d.sigma_pitch.push_back(2e-4F), d.sigma_heading.push_back(4e-4F);
  }
  return d;
}

struct Orientation {
  Work work;
  std::unique_ptr<Stage> stage;
  core::Tally tally;
  core::Value findings;
  explicit Orientation(const std::string& options = {}) : stage(stage_with("orientation.direct", options)) {
    work.survey.crs = "EPSG:32632";
    work.survey.events.emplace_back().file = "events.csv";
    io::SurveyCamera& camera = work.survey.cameras.emplace_back();
    camera.name = "P1", camera.lever_arm[2] = core::Metres(2.0);
    work.context.crs = core::Crs(work.survey.crs);
    work.context.records.put(trajectory::Trajectory(northward()));
  }
  void expose(std::vector<double> times) {
    core::EventData e;
    e.time = times;
    for (size_t k = 0; k < times.size(); ++k) {
      e.sigma.push_back(0.0), e.strip.push_back(1), e.technique.push_back("camera"), e.doubtful.push_back(0);
      e.id.push_back("dsc" + std::to_string(k + 1));
    }
    work.context.records.put(e);
  }
};

TEST(DirectOrientationStage, EachExposureWithinTheTrajectoryIsARowOfBothTables) {
  Orientation o;
  EXPECT_EQ(fault_of([&] { o.stage->check(o.work.context); }), "");
  o.expose({1002.0, 1004.0, 2000.0});
  o.stage->run_survey(o.work.context, o.tally, o.findings);
  EXPECT_EQ(o.findings.find("events")->as_int(), 3);
  EXPECT_EQ(o.findings.find("images")->as_int(), 2);
  EXPECT_EQ(o.findings.find("outside")->as_int(), 1);
  EXPECT_NEAR(o.findings.find("sigma_height_m")->as_number(), 0.05, 1e-4);
  const io::TextTable images(o.work.context.output / "images.csv");
  ASSERT_EQ(images.rows(), 2u);
  EXPECT_NEAR(images.number(0, images.column("x")), 500000.0, 1e-3);
  EXPECT_NEAR(images.number(0, images.column("z")), height - 2.0, 1e-3);
  // 100 m along the meridian, scaled by the projection.
  EXPECT_NEAR(images.number(1, images.column("y")) - images.number(0, images.column("y")), 0.9996 * 100.0, 0.02);
  EXPECT_NE(test::read_bytes(o.work.context.output / "orientation_direct.csv").find("\ndsc2,P1,1,"), std::string::npos);
  // Of both images, and between them: north after 2 s of 150.
  const io::TextTable pairs(o.work.context.output / "orientation_correlation.csv");
  ASSERT_EQ(pairs.rows(), 3u);
  EXPECT_EQ(pairs.text(1, 0) + " " + pairs.text(1, 1), "dsc2 dsc1");
  const size_t north = pairs.column("c22"), roll = pairs.column("c44");
  EXPECT_NEAR(pairs.number(0, north), 0.02 * 0.02 + 4.0 * 4e-8, 1e-6);  // and the pitch by the lever arm
  EXPECT_NEAR(pairs.number(0, roll), 1e-8, 1e-12);
  EXPECT_NEAR(pairs.number(1, roll), 1e-8 * std::exp(-2.0 / 200.0), 1e-12);
}

TEST(DirectOrientationStage, WithoutPairedImagesThereIsNoFileOfThem) {
  Orientation o("correlated_images = 0\n");
  o.expose({1002.0, 1004.0});
  o.stage->run_survey(o.work.context, o.tally, o.findings);
  EXPECT_TRUE(fs::exists(o.work.context.output / "images.csv"));
  EXPECT_FALSE(fs::exists(o.work.context.output / "orientation_correlation.csv"));
}

TEST(DirectOrientationStage, AListNamesTheImages) {
  Orientation o;
  o.work.survey.folder = o.work.context.output;
  o.work.survey.images.emplace_back().file = "list.csv";
  test::write_bytes(o.work.context.output / "list.csv", "name,event\nA 17.jpg,dsc2\n");
  EXPECT_EQ(o.stage->inputs(o.work.survey), std::vector<fs::path>{o.work.context.output / "list.csv"});
  o.expose({1002.0, 1004.0});
  o.work.survey.cameras[0].sigma.boresight = "free";
  o.stage->run_survey(o.work.context, o.tally, o.findings);
  EXPECT_EQ(o.findings.find("images")->as_int(), 1);
  EXPECT_EQ(o.findings.find("events_without_image")->as_int(), 1);
  EXPECT_EQ(o.findings.find("without")->items().at(0).as_text(), "boresight of P1");
  EXPECT_EQ(io::TextTable(o.work.context.output / "images.csv").text(0, 0), "A 17.jpg");
}

TEST(DirectOrientationStage, WhatItNeedsIsNamedBeforeTheRun) {
  Orientation o;
  o.work.survey.height_unit = core::Metres(0.3048);
  EXPECT_NE(fault_of([&] { o.stage->check(o.work.context); }).find("not in height_unit"), std::string::npos);
  o.work.survey.crs = "EPSG:32632+5703";
  EXPECT_EQ(fault_of([&] { o.stage->check(o.work.context); }), "");
  o.work.survey.height_unit.reset();
  o.work.survey.cameras[0].sigma.lever_arm = "2";
  EXPECT_NE(fault_of([&] { o.stage->check(o.work.context); }).find("camera.sigma.lever_arm"), std::string::npos);
  o.work.survey.cameras.clear();
  EXPECT_NE(fault_of([&] { o.stage->check(o.work.context); }).find("[[camera]]"), std::string::npos);
  o.work.survey.events.clear();
  EXPECT_NE(fault_of([&] { o.stage->check(o.work.context); }).find("[[event]]"), std::string::npos);
  o.work.survey.crs.clear();
  EXPECT_NE(fault_of([&] { o.stage->check(o.work.context); }).find("no CRS"), std::string::npos);
  Orientation late;
  late.expose({2000.0});
  EXPECT_NE(fault_of([&] { late.stage->run_survey(late.work.context, late.tally, late.findings); }), "");
  EXPECT_FALSE(fs::exists(late.work.context.output / "images.csv"));
}

}  // namespace
}  // namespace swath::stages
