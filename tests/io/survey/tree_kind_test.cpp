// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/tree_kind.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "io/survey/read_survey.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TreeKind kind(const std::string& toml) { return kind_of(parse_toml(toml, "a.toml")); }

TEST(TreeKind, FollowsFromTheKeys) {
  EXPECT_EQ(kind("[[stage]]\ntype = \"readers.las\"\n"), TreeKind::pipeline);
  EXPECT_EQ(kind("crs = \"EPSG:32632\"\n[[laser]]\n[calibration]\n[sigma]\n"), TreeKind::survey);
  EXPECT_EQ(kind("[[imu]]\n[imu_spec]\n[[gnss]]\n"), TreeKind::survey);
  EXPECT_EQ(kind("hangar = \"hangar.toml\"\n"), TreeKind::survey);
  EXPECT_EQ(kind("[[point]]\n[[station]]\n"), TreeKind::hangar);
  EXPECT_EQ(kind("fingerprint = \"0\"\ntasks = []\n"), TreeKind::tasks);
  EXPECT_EQ(kind("program = \"swath 1\"\nstages = []\n"), TreeKind::report);
  EXPECT_EQ(kind("[calibration]\n[sigma]\n"), TreeKind::calibration);
  EXPECT_EQ(kind("crs = \"EPSG:32632\"\nverdict = \"\"\n[calibration]\n[sigma]\n[flight]\n"), TreeKind::calibration) << "with its report";
  EXPECT_EQ(kind("crs = \"EPSG:32632\"\ndirection_deg = 0.0\nline_length_m = 1.0\n[[lines]]\n"), TreeKind::planned_flight);
  EXPECT_EQ(kind("[sensor]\n[flight]\n[simulate]\n"), TreeKind::flight_plan);
  EXPECT_EQ(kind("[[camera]]\n[images]\n[[image_points]]\n"), TreeKind::block);
  EXPECT_EQ(kind("[[camera]]\n[[image_points]]\n[[event]]\n"), TreeKind::survey) << "a block of a survey";
  EXPECT_EQ(kind("sigma_image = \"20 um\"\n"), TreeKind::block_theory);
  EXPECT_EQ(kind("[world]\n[flight]\n[scanner]\n"), TreeKind::simulation);
  EXPECT_EQ(kind("hierarchyType = \"json\"\nschema = []\npoints = 4\n"), TreeKind::entwine);
  EXPECT_EQ(kind("[run]\n"), TreeKind::other);
  EXPECT_EQ(kind_of(parse_json("[1, 2]", "a.json")), TreeKind::other);
}

TEST(TreeKind, FormatsAndKindsAreOneToOne) {
  for (const TreeKind k : {TreeKind::pipeline, TreeKind::survey, TreeKind::hangar, TreeKind::tasks, TreeKind::report, TreeKind::calibration,
                           TreeKind::flight_plan, TreeKind::block, TreeKind::block_theory, TreeKind::simulation, TreeKind::entwine,
                           TreeKind::planned_flight}) {
    EXPECT_EQ(kind_of_format(format_of(k)), k) << format_of(k);
    EXPECT_FALSE(use_of(k).empty());
  }
  EXPECT_EQ(kind_of_format("LAZ"), TreeKind::other);
}

TEST(TreeKind, AFileOfAnotherKindIsRefusedWithItsUse) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "hangar.toml", "[[point]]\nname = \"imu\"\n[[station]]\nname = \"S1\"\n");
  try {
    read_survey(folder / "hangar.toml");
    ADD_FAILURE() << "was taken as a survey";
  } catch (const core::Error& e) {
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    EXPECT_NE(e.text().find("hangar.toml"), std::string::npos) << e.text();
    EXPECT_NE(e.text().find("it is a hangar survey, not a survey"), std::string::npos) << e.text();
    EXPECT_NE(e.hint().find("swath run lever_arm"), std::string::npos) << e.hint();
  }
  EXPECT_NO_THROW(require_kind(parse_toml("[run]\n", "a.toml"), TreeKind::pipeline, "a.toml")) << "its own reader says what is missing";
  const char* open = "crs = \"EPSG:32632\"\n[flight]\n[scanner]\n[imu]\n";
  EXPECT_NO_THROW(require_kind(parse_toml(open, "a.toml"), TreeKind::simulation, "a.toml")) << "a survey has a crs and a scanner as well";
}

}  // namespace
}  // namespace swath::io
