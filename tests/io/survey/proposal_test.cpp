// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/proposal.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <regex>

#include "core/error.h"
#include "io/survey/read_survey.h"
#include "io/text/value_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

/// The proposal as a person would complete it: the line below each question counts.
std::string completed(const std::string& toml) { return std::regex_replace(toml, std::regex("# \\? [^\n]*\n# "), ""); }

bool is_open(const Proposal& p, const std::string& key) {
  return std::any_of(p.open.begin(), p.open.end(), [&](const std::string& one) { return one.starts_with(key + ": "); });
}

TEST(Proposal, RecordsOfAFlightByTheNamesOfTheirColumns) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "laser.csv", "gps_sow_s,line,scan_angle_deg,range_m\n474009,1,-20.5,500.1\n474010,1,20.5,500.2\n");
  test::write_bytes(folder / "nav/imu.csv", "time,gx,gy,gz,ax,ay,az\n1,0,0,0,0,0,-9.8\n2,0,0,0,0,0,-9.8\n");
  test::write_bytes(folder / "nav/gnss.csv", "gps_sow_s,lat_deg,lon_deg,h_ell_m\n474006,47.9,10.5,1127\n474007,47.9,10.5,1127\n");
  test::write_bytes(folder / "notes.txt", "weather was fine\n");
  test::write_bytes(folder / ".hidden.csv", "gps_sow_s,lat_deg,lon_deg,h_ell_m\n1,2,3,4\n");
  test::write_bytes(folder / "products/report.json", "{}");
  test::write_bytes(folder / "products/events.csv", "time,id\n1,2\n");
  std::size_t called = 0;
  const auto found = find_records(folder.path(), [&](std::size_t done, std::size_t all, const fs::path&) {
    EXPECT_EQ(done, called++);
    EXPECT_EQ(all, 4u);
  });
  ASSERT_EQ(found.size(), 4u) << "hidden files and products are passed over";
  const Proposal p = propose_survey(found, "lech");
  EXPECT_EQ(p.files, 3u);
  for (const char* key : {"crs", "laser[1].time", "imu[1].time", "imu[1].kind", "imu[1].angle_unit", "imu[1].acceleration_unit",
                          "gnss[1].time", "antenna.lever_arm", "scanner.model", "calibration.roll", "calibration.lever_arm_scanner"})
    EXPECT_TRUE(is_open(p, key)) << key << "\n" << p.toml;
  EXPECT_FALSE(is_open(p, "gnss[1].angle_unit")) << "lat_deg says it";
  EXPECT_NE(p.toml.find("notes.txt"), std::string::npos) << "what has no place is named";
  EXPECT_NE(p.toml.find("EPSG:32632"), std::string::npos) << "the zone of the fixes: " << p.toml;

  test::write_bytes(folder / "survey.toml", p.toml);
  EXPECT_THROW(read_survey(folder / "survey.toml"), core::Error) << "what is open is missed";
  test::write_bytes(folder / "survey.toml", completed(p.toml));
  const Survey survey = read_survey(folder / "survey.toml");
  EXPECT_EQ(survey.name, "lech");
  ASSERT_EQ(survey.laser.size(), 1u);
  EXPECT_EQ(survey.laser[0].columns.range, "range_m");
  ASSERT_EQ(survey.imu.size(), 1u);
  EXPECT_EQ(survey.imu[0].file, "nav/imu.csv");
  ASSERT_EQ(survey.gnss.size(), 1u);
  EXPECT_EQ(survey.gnss[0].columns.latitude, "lat_deg");
}

FoundFile file(const std::string& name, const std::string& facts) { return {name, parse_json(facts, name), ""}; }

TEST(Proposal, CloudsAndScannerFramesAreNotTheSame) {
  const std::string frame = R"({"format": "LAS", "x": [-2.0, 3.0], "y": [-220.0, 215.0], "z": [480.0, 640.0],
                                "time": {"scale": "seconds of the GPS week"}})";
  const std::string map =
      R"({"format": "LAZ", "crs": "ETRS89 / UTM zone 32N", "x": [0.0, 3.0], "y": [-220.0, 215.0], "z": [480.0, 640.0]})";
  const Proposal clouds = propose_survey({file("map.laz", map)}, "m");
  EXPECT_NE(clouds.toml.find("[[points]]\nfile = \"map.laz\""), std::string::npos) << clouds.toml;
  EXPECT_TRUE(clouds.open.empty()) << clouds.open.front();
  const Proposal raw = propose_survey({file("frame.las", frame), file("map.laz", map)}, "m");
  EXPECT_NE(raw.toml.find("[[laser]]\nfile = \"frame.las\""), std::string::npos) << raw.toml;
  EXPECT_EQ(raw.toml.find("[[points]]"), std::string::npos) << "a survey has one or the other";
  EXPECT_TRUE(is_open(raw, "laser[1].time"));
  EXPECT_EQ(raw.toml.find("may be the same records"), std::string::npos);
  const Proposal twice = propose_survey({file("frame.las", frame), file("a.csd", R"({"format": "Optech CSD"})")}, "m");
  EXPECT_NE(twice.toml.find("may be the same records"), std::string::npos) << twice.toml;
  const Proposal bare = propose_survey({file("bare.laz", R"({"format": "LAZ", "x": [5e5, 5.1e5], "y": [5e6, 5.1e6], "z": [0, 9]})")}, "m");
  EXPECT_TRUE(is_open(bare, "points[1].crs"));
}

TEST(Proposal, FormatsWithTheirOwnFields) {
  const Proposal p = propose_survey(
      {file("a.csd", R"({"format": "Optech CSD", "carrier_latitude_deg": [-1.0, -0.9], "carrier_longitude_deg": [11, 11.1]})"),
       file("a.out", R"({"format": "SBET"})"),
       file("a.smrmsg", R"({"format": "smrmsg"})"),
       file("fix.txt", R"({"format": "RTKLIB solution"})"),
       file("log.nmea", R"({"format": "NMEA", "fixes": 0})"),
       file("r.obs", R"({"format": "RINEX", "kind": "observations"})"),
       file("b.obs", R"({"format": "RINEX", "kind": "observations"})"),
       file("n.nav", R"({"format": "RINEX", "kind": "navigation messages"})"),
       {"broken.laz", {}, "the file is cut off"}},
      "m");
  EXPECT_EQ(p.files, 8u);
  EXPECT_NE(p.toml.find("calibration_file = \"a.csd\""), std::string::npos);
  EXPECT_NE(p.toml.find("accuracy = \"a.smrmsg\""), std::string::npos);
  EXPECT_NE(p.toml.find("file = \"fix.txt\"\nformat = \"pos\""), std::string::npos) << "its ending does not say it: " << p.toml;
  EXPECT_NE(p.toml.find("navigation = [\"n.nav\"]"), std::string::npos);
  EXPECT_NE(p.toml.find("broken.laz: cannot be read: the file is cut off"), std::string::npos);
  EXPECT_NE(p.toml.find("EPSG:32732"), std::string::npos) << "southern zone 32";
  EXPECT_TRUE(is_open(p, "trajectory[1].time"));
  EXPECT_TRUE(is_open(p, "gnss[2].time"));
  EXPECT_TRUE(is_open(p, "rinex.rover")) << "which of two is the aircraft's";
  EXPECT_NO_THROW(parse_toml(completed(p.toml), "made"));
}

TEST(Proposal, WhatCannotBeReadIsNamedAndTheRestIsProposed) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.pos", "% GPST latitude(deg) longitude(deg) height(m) Q ns\n");
  test::write_bytes(folder / "cut.las", "LASF");
  test::write_bytes(folder / "empty.csv", "");
  test::write_bytes(folder / "laser.csv", "gps_sow_s,range_m\n474009,500.1\n474010,500.2\n");
  fs::create_symlink("nothing.laz", folder / "linked.laz");
  fs::create_directory_symlink(".", folder / "itself");
  ASSERT_EQ(::mkfifo((folder / "pipe.csv").c_str(), 0600), 0);
  const auto found = find_records(folder.path());
  ASSERT_EQ(found.size(), 6u) << "a link to a folder is passed over";
  const Proposal p = propose_survey(found, "odd");
  EXPECT_NE(p.toml.find("[[laser]]\nfile = \"laser.csv\""), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("cut.las: cannot be read: "), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("empty.csv: cannot be read: the file is empty"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("linked.laz: cannot be read: the link leads to nothing"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("pipe.csv: cannot be read: it is not a file"), std::string::npos) << p.toml;
}

TEST(Proposal, AHangarSurveyIsNamedWithItsConfig) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "hangar.toml", "[[point]]\nname = \"imu\"\n[[station]]\nname = \"S1\"\n");
  test::write_bytes(folder / "tasks.json", R"({"fingerprint": "0", "tasks": []})");
  Proposal p = propose_survey(find_records(folder.path()), "hall");
  EXPECT_EQ(p.files, 1u);
  EXPECT_EQ(p.config, "lever_arm");
  EXPECT_NE(p.toml.find("swath run lever_arm --survey survey.toml"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("tasks.json: a list of tasks, not a record: swath task ID --tasks FILE"), std::string::npos) << p.toml;
  test::write_bytes(folder / "survey.toml", p.toml);
  EXPECT_EQ(read_survey(folder / "survey.toml").hangar, "hangar.toml");
  test::write_bytes(folder / "gnss.csv", "gps_sow_s,lat_deg,lon_deg,h_ell_m\n474006,47.9,10.5,1127\n474007,47.9,10.5,1127\n");
  p = propose_survey(find_records(folder.path()), "hall");
  EXPECT_EQ(p.config, "survey");
  EXPECT_NE(p.toml.find("hangar = \"hangar.toml\""), std::string::npos) << "beside the records of a flight, too: " << p.toml;
}

TEST(Proposal, AFolderThatIsNotThere) { EXPECT_THROW(find_records("no/such/folder"), core::Error); }

TEST(Proposal, ImagePointsAskForTheCameraAndTheirConventions) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "events.csv", "unix_time,id\n1700000000,1\n1700000003,2\n");
  test::write_bytes(folder / "measured.csv", "photo,point,x,y\n1,a,10,20\n2,a,30,40\n");
  const Proposal p = propose_survey(find_records(folder.path(), {}), "images");
  for (const char* key : {"camera[1].f", "camera[1].mount", "camera[1].lever_arm", "image_points[1].unit", "image_points[1].y",
                          "image_points[1].origin", "image_points[1].sigma_pixels"})
    EXPECT_TRUE(is_open(p, key)) << key << "\n" << p.toml;
  EXPECT_NE(p.toml.find("image_column = \"photo\""), std::string::npos) << p.toml;
  EXPECT_EQ(p.toml.find("point_column"), std::string::npos) << "as it is by default";
  test::write_bytes(folder / "survey.toml", p.toml);
  EXPECT_THROW(read_survey(folder / "survey.toml"), core::Error) << "what is open is missed";
  test::write_bytes(folder / "survey.toml", completed(p.toml));
  const Survey survey = read_survey(folder / "survey.toml");
  EXPECT_EQ(survey.cameras.at(0).columns, 7216);
  EXPECT_EQ(survey.image_points.at(0).image_column, "photo");
}

}  // namespace
}  // namespace swath::io
