// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/flat_target_report.h"

#include <gtest/gtest.h>

#include "core/config/units.h"

namespace swath::calib {
namespace {

calib::FlatTarget some_result() {
  calib::FlatTarget t;
  t.done = true;
  t.target.name = "hall";
  t.target.frame = trajectory::local_frame({4177000.0, 774000.0, 4710000.0});
  t.target.corners = {{30, 15}, {-30, 15}, {-30, -15}, {30, -15}};
  calib::TargetLine l;
  l.line = 4;
  l.measured = true;
  l.role = calib::TargetRole::edge;
  l.before.seen = l.after.seen = true;
  l.before.displacement = {1.5, -0.5};
  l.before.covariance = l.after.covariance = Eigen::Matrix2d::Identity() * 4e-4;
  for (const double offset : {0.5, 1.5, -0.5, -1.5}) {
    calib::SideView s;
    s.used = true;
    s.offset = offset;
    l.before.sides.push_back(s);
    s.offset = 0.01 * offset;
    l.after.sides.push_back(s);
  }
  t.lines.push_back(l);
  l.line = 5;
  l.measured = l.before.seen = l.after.seen = false;
  l.before.why_not = l.after.why_not = "no returns near the target";
  t.lines.push_back(l);
  t.pitch.determined = t.pitch.beyond = true;
  t.pitch.mean = t.pitch.value = 0.1 * core::degree;
  t.pitch.sigma = t.pitch.own = 2e-5;
  calib::Reading r;
  r.first = 1, r.second = 2;
  r.value = 0.1 * core::degree, r.sigma = 2e-5;
  t.pitch.readings.push_back(r);
  r.second = -1;
  r.value = 0.12, r.sigma = 0.03;
  t.range_determined = true;
  t.range_mean = 0.12;
  t.range_readings.push_back(r);
  t.findings = {"roll is not determined"};
  return t;
}

TEST(FlatTargetReport, TellsAllInOneTree) {
  const core::Value v = value_of(some_result());
  EXPECT_NEAR(v.find("pitch")->find("mean_deg")->as_number(), 0.1, 1e-12);
  EXPECT_TRUE(v.find("pitch")->find("beyond_tolerance")->as_bool());
  EXPECT_EQ(v.find("pitch")->find("readings")->items().size(), 1u);
  EXPECT_FALSE(v.find("roll")->find("determined")->as_bool());
  EXPECT_EQ(v.find("roll")->find("mean_deg"), nullptr);
  ASSERT_EQ(v.find("lines")->items().size(), 2u);
  const core::Value& line = v.find("lines")->items()[0];
  EXPECT_EQ(line.find("role")->as_text(), "edge");
  EXPECT_NEAR(line.find("before")->find("along_m")->as_number(), 1.5, 1e-12);
  EXPECT_EQ(v.find("lines")->items()[1].find("before")->find("why_not")->as_text(), "no returns near the target");
  EXPECT_EQ(v.find("target")->find("corners")->items().size(), 4u);
  const core::Value s = summary_of(some_result());
  EXPECT_EQ(s.find("pitch")->find("readings"), nullptr);
  EXPECT_EQ(s.find("findings")->items()[0].as_text(), "roll is not determined");
  EXPECT_EQ(s.find("lines"), nullptr);
}

TEST(FlatTargetReport, ReadingsAsATable) {
  const std::string csv = readings_csv(some_result());
  EXPECT_NE(csv.find("pitch,1,2,0.1,deg,4.12"), std::string::npos) << csv;
  EXPECT_NE(csv.find("range_offset,1,,0.12,m,0.03,m"), std::string::npos) << csv;
}

TEST(FlatTargetReport, IsDrawn) {
  const report::Chart c = chart_of(some_result());
  ASSERT_EQ(c.panels.size(), 4u);
  EXPECT_NE(c.panels[1].title.find("enlarged 2 times"), std::string::npos) << c.panels[1].title;
  EXPECT_NE(c.panels[2].title.find("enlarged 200 times"), std::string::npos) << c.panels[2].title;
  const core::Picture p = report::draw(c);
  EXPECT_GT(p.height, 1000);
  EXPECT_TRUE(chart_of({}).panels.empty());
  EXPECT_FALSE(value_of(calib::FlatTarget{}).find("done")->as_bool());
}

}  // namespace
}  // namespace swath::calib
