// SPDX-License-Identifier: GPL-3.0-or-later
// The stage time.latency, run on its own.
#include <gtest/gtest.h>

#include <cmath>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/text/value_file.h"
#include "stages/registry.h"
#include "tests/world/support.h"

namespace swath::stages {
namespace {

constexpr double start = 1.4e9;

/// A flight that turns and changes its speed; IMU centre, attitude level but for the heading.
core::TrajectoryData flown_data(bool straight) {
  core::TrajectoryData d;
  const Eigen::Vector3d origin = core::ecef_of({48 * core::degree, 9 * core::degree, 1000.0});
  const Eigen::Matrix3d ecef_R_ned = core::ecef_R_ned(48 * core::degree, 9 * core::degree);
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  for (int i = 0; i <= 12000; ++i) {
    const double t = 0.02 * i, heading = straight ? 0.0 : 0.5 * std::sin(t / 12.0),
                 speed = straight ? 50.0 : 50.0 + 8.0 * std::sin(t / 9.0);
    const core::Geodetic g = core::geodetic_of(origin + ecef_R_ned * p);
    d.time.push_back(start + t);
    d.latitude.push_back(g.latitude), d.longitude.push_back(g.longitude), d.height.push_back(g.height);
    d.roll.push_back(0.0), d.pitch.push_back(0.0), d.heading.push_back(core::wrap_two_pi(heading));
    p += 0.02 * speed * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0.0);
  }
  return d;
}

struct LatencyTrial {
  test::TemporaryFolder folder;
  io::Survey survey;
  Context context{survey};
  std::unique_ptr<Stage> stage = make_stage("time.latency");
  core::Tally tally;
  core::Value findings;
  trajectory::Trajectory flown;

  explicit LatencyTrial(bool straight = false) : flown(flown_data(straight)) {
    context.output = folder.path();
    survey.antenna.lever_arm = {core::Metres(0.3), core::Metres(-0.2), core::Metres(-1.1)};
    context.records.put(flown);
  }
  /// Places of the antenna at 1 Hz, tagged `late` seconds after.
  void places(std::vector<double>& time, std::vector<Eigen::Vector3d>& place, double late) {
    for (int i = 5; i < 230; ++i) {
      const auto pose = flown.pose_at(start + i);
      time.push_back(start + i + late);
      place.push_back(pose->position + pose->ecef_R_body * Eigen::Vector3d(0.3, -0.2, -1.1));
    }
  }
  void set(const std::string& json) {
    std::vector<core::Fault> faults;
    core::read_options([&](core::Visitor& v) { stage->visit(v); }, io::parse_json(json, "options"), "", faults);
    for (const auto& f : faults) ADD_FAILURE() << f.text();
  }
  void go() { stage->run_survey(context, tally, findings); }
};

constexpr double close = 2e-4;  // s: the trajectory's cubics at 50 Hz hold 1 cm at 50 m/s

TEST(LatencyStage, OfFixesWithTheirLeverArm) {
  LatencyTrial t;
  core::GnssData gnss;
  t.places(gnss.time, gnss.position, 0.08);
  t.context.records.put(gnss);
  t.go();
  EXPECT_TRUE(t.findings.find("determinable")->as_bool());
  EXPECT_NEAR(t.findings.find("latency_s")->as_number(), -0.08, close);
  EXPECT_EQ(io::to_json(io::read_value_file(t.folder / "latency.json")), io::to_json(t.findings));
  EXPECT_TRUE(t.tally.empty());
}

TEST(LatencyStage, OfEventsWithPlaces) {
  LatencyTrial t;
  core::EventData events;
  t.places(events.time, events.place, -0.3);
  t.context.records.put(events);
  t.set(R"({"device": "events", "search": "1 s"})");
  t.go();
  EXPECT_NEAR(t.findings.find("latency_s")->as_number(), 0.3, close);
}

TEST(LatencyStage, WhatIsNotDeterminableHasItsReason) {
  LatencyTrial t(true);
  core::GnssData gnss;
  t.places(gnss.time, gnss.position, 0.08);
  t.context.records.put(gnss);
  t.set(R"({"shift": "track"})");
  t.go();
  EXPECT_FALSE(t.findings.find("determinable")->as_bool());
  EXPECT_NE(t.findings.find("reason")->as_text().find("alike in this motion"), std::string::npos) << t.findings.find("reason")->as_text();
  EXPECT_EQ(t.findings.find("latency_s"), nullptr);
  EXPECT_EQ(t.tally.of("latency not determinable"), 1u);  // the reason is an example, not a key
}

TEST(LatencyStage, WithoutItsRecordsItSaysWhichStageIsMissing) {
  LatencyTrial t;
  for (const auto& [device, hint] : {std::pair{"gnss", "readers.gnss"}, {"events", "time.sync"}}) {
    t.set(std::string(R"({"device": ")") + device + "\"}");
    try {
      t.go();
      FAIL();
    } catch (const core::Error& e) {
      EXPECT_NE(e.hint().find(hint), std::string::npos);
    }
  }
  core::EventData events;
  events.time = {start + 10};
  events.place = {Eigen::Vector3d::Constant(std::nan(""))};
  t.context.records.put(events);
  EXPECT_THROW(t.go(), core::Error);
  EXPECT_EQ(test::entries(t.folder.path()), 0u);
}

}  // namespace
}  // namespace swath::stages
