// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/target/target_findings.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace swath::calib {
namespace {

bool says(const std::vector<std::string>& findings, const std::string& what) {
  return std::any_of(findings.begin(), findings.end(), [&](const std::string& f) { return f.find(what) != std::string::npos; });
}

// Everything determined, at two heights, by lines at nadir and at the edge.
struct Found {
  FlatTarget target;
  AngleReadings readings;
  TargetMeasures measures;

  Found() {
    target.target.corners = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
    target.rounds = 4;
    for (TargetAngle* a : {&target.roll, &target.pitch, &target.heading}) a->determined = true, a->sigma = 1e-5;
    for (ReadingMean* r : {&readings.roll, &readings.pitch, &readings.heading}) r->determined = true;
    measures.lines.resize(1);
    measures.lines[0].role = TargetRole::edge;
    target.joint.two_heights = true;
    target.joint.lever_forward.sigma = target.joint.lever_right.sigma = 0.01;
    target.joint.datum_sigma.setConstant(2.0);
  }
  std::vector<std::string> findings(bool steady = true) const { return target_findings(target, readings, measures, {}, steady).findings; }
};

TEST(TargetFindings, AGoodFlightHasNoErrorOfTheLeverArm) {
  const Found f;
  EXPECT_TRUE(f.findings().empty());  // what is right is not a warning
  const auto all = target_findings(f.target, f.readings, f.measures, {}, true).notes;
  ASSERT_EQ(all.size(), 2u) << all.back();
  EXPECT_TRUE(says(all, "the along-track displacement grows with height as pitch does"));
  EXPECT_TRUE(says(all, "the across-track displacement grows with height as roll does"));
}

TEST(TargetFindings, EachFaultIsNamed) {
  Found f;
  f.readings.roll.determined = false;
  f.target.roll.determined = false;
  f.measures.lines[0].role = TargetRole::nadir;
  f.target.joint.lever_forward.value = -0.2;
  f.target.joint.scan_scale = {true, 4e-4, 1e-4};
  f.target.joint.chi2 = 9.0;
  TargetLine unseen;
  unseen.line = 7;
  unseen.after.why_not = "no returns near the target";
  f.target.lines.push_back(unseen);
  const auto all = f.findings(false);
  EXPECT_TRUE(says(all, "roll is not determined"));
  EXPECT_FALSE(says(all, "pitch is not determined"));
  EXPECT_TRUE(says(all, "heading is weak"));
  EXPECT_TRUE(says(all, "lever arm +0.200 m"));
  EXPECT_TRUE(says(all, "too wide across the flight: scan scale off by 400 +-100 ppm"));
  EXPECT_TRUE(says(all, "(chi2 per degree of freedom 9.0)"));
  EXPECT_TRUE(says(all, "line 7 takes no part, no returns near the target: "));
  EXPECT_TRUE(says(all, "before the angles were steady (4 rounds)"));
  // Each ends with what to do.
  for (const std::string& finding : all) EXPECT_GT(finding.size(), finding.rfind(": ") + 12) << finding;
  for (const std::string& finding : all) EXPECT_NE(finding.rfind(": "), std::string::npos) << finding;
  f.target.joint.two_heights = false;
  EXPECT_TRUE(says(f.findings(), "all lines are of one flying height"));
}

TEST(TargetFindings, ADatumCountsWhereItIsKnown) {
  Found f;
  f.target.joint.datum = {0.3, -0.1, 0.0};
  EXPECT_FALSE(says(f.findings(), "in all lines alike"));
  f.target.joint.datum_sigma.setConstant(0.02);
  EXPECT_TRUE(says(f.findings(), "0.30 m east and -0.10 m north (+-0.02 m) of its survey in all lines alike"));
}

}  // namespace
}  // namespace swath::calib
