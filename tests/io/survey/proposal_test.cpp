// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/proposal.h"

#include <gtest/gtest.h>

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

/// The proposal of one text file.
Proposal proposed_of(const std::string& text) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", text);
  return propose_survey(find_records(folder.path()), "a");
}

TEST(Proposal, HeightsAboveTheSeaAndForeignQualityCodesAreDoubted) {
  const Proposal p =
      proposed_of("gps_sow_s,gps_week,lat_deg,lon_deg,h_ell_m,quality\n474006,2317,47.9,10.5,1127,1\n474007,2317,47.9,10.5,1127,1\n");
  EXPECT_EQ(p.toml.find(", quality = "), std::string::npos) << p.toml;
  EXPECT_TRUE(is_open(p, "gnss[1].columns"));
  const Proposal log = proposed_of("timestamp,Lat,Lng,Alt\n1717760406,47.9,10.5,1079\n1717760407,47.9,10.5,1079\n");
  EXPECT_TRUE(is_open(log, "gnss[1].columns")) << log.toml;
  const Proposal plain = proposed_of("gps_sow_s,lat_deg,lon_deg,h_ell_m\n474006,47.9,10.5,1127\n474007,47.9,10.5,1127\n");
  EXPECT_FALSE(is_open(plain, "gnss[1].columns")) << plain.toml;
  const Proposal zeros = proposed_of("time,lat_deg,lon_deg,h_ell_m\n1,0,0,0\n2,47.9,10.5,1127\n");
  EXPECT_EQ(zeros.toml.find("EPSG:32631"), std::string::npos) << "rows of zeros lie in no zone: " << zeros.toml;
}

TEST(Proposal, AnExportOfPospacIsATrajectory) {
  const Proposal p = proposed_of(
      " TIME, DISTANCE, EASTING, NORTHING, ELLIPSOID HEIGHT, LATITUDE, LONGITUDE, ELLIPSOID HEIGHT, ROLL, PITCH, HEADING\n"
      "474009.0,12.3,500123.1,5300456.2,611.2,47.9064,10.512,611.2,0.5,1.2,88.0\n"
      "474009.1,12.4,500123.2,5300456.2,611.2,47.9064,10.512,611.2,0.5,1.2,88.0\n");
  EXPECT_NE(p.toml.find("[[trajectory]]"), std::string::npos) << p.toml;
  EXPECT_EQ(p.toml.find("[[laser]]"), std::string::npos) << "the distance is the way flown";
  EXPECT_NE(p.toml.find("latitude = \"LATITUDE\", longitude = \"LONGITUDE\", height = \"5\""), std::string::npos) << p.toml;
}

TEST(Proposal, TheRowOfUnitsSaysWhatTheAnglesAre) {
  const std::string names = "Project: a\n\n  GPSTime   Latitude   Longitude   H-Ell   Roll   Pitch   Heading  Q\n";
  const std::string rows = "474009.0 47.9 10.5 611.2 0.5 1.2 88.0 1\n474009.1 47.9 10.5 611.2 0.5 1.2 88.0 1\n";
  const Proposal p = proposed_of(names + "    (sec)      (deg)       (deg)     (m)  (deg)   (deg)     (deg)\n" + rows);
  EXPECT_NE(p.toml.find("\nangle_unit = \"deg\""), std::string::npos) << p.toml;
  EXPECT_FALSE(is_open(p, "trajectory[1].angle_unit")) << p.toml;
  const Proposal mixed = proposed_of(names + "    (sec)      (deg)       (deg)    (ft)  (rad)   (rad)     (rad)\n" + rows);
  EXPECT_NE(mixed.toml.find("some columns are in deg and others in rad"), std::string::npos) << mixed.toml;
  EXPECT_NE(mixed.toml.find("H-Ell has a unit that is not read"), std::string::npos) << mixed.toml;
}

TEST(Proposal, AnExportOfPospacBetweenBlanksHasNamesOfSeveralWords) {
  const Proposal p = proposed_of(
      "POSPac MMS Export\nMission: 12\n"
      "     TIME   DISTANCE    EASTING    NORTHING  ELLIPSOID HEIGHT   LATITUDE  LONGITUDE  ELLIPSOID HEIGHT   ROLL  PITCH  HEADING\n"
      "    (time in Sec, distance in Meters, position in Meters, lat, long in Degrees, orientation angles in Degrees)\n\n"
      "474009.0 12.3 500123.1 5300456.2 611.2 47.9064 10.512 611.2 0.5 1.2 88.0\n"
      "474009.1 12.4 500123.2 5300456.2 611.2 47.9064 10.512 611.2 0.5 1.2 88.0\n");
  EXPECT_NE(p.toml.find("latitude = \"LATITUDE\", longitude = \"LONGITUDE\", height = \"5\""), std::string::npos) << p.toml;
}

TEST(Proposal, ATrajectoryByXAndYAsksWhichIsTheNorthing) {
  const std::string row = "474009.0,5300456.2,500123.1,611.2,0.5,1.2,88.0\n474009.1,5300456.3,500123.1,611.2,0.5,1.2,88.0\n";
  const Proposal open = proposed_of("GpsTime,Y,X,Z,Roll,Pitch,Azimuth\n" + row);
  EXPECT_NE(open.toml.find("[[trajectory]]"), std::string::npos) << open.toml;
  EXPECT_TRUE(is_open(open, "trajectory[1].columns") && is_open(open, "trajectory[1].crs")) << open.toml;
  EXPECT_NE(open.toml.find("# columns = { time = \"GpsTime\""), std::string::npos) << open.toml;
  EXPECT_NE(open.toml.find("latitude = \"Y\", longitude = \"X\", height = \"Z\""), std::string::npos) << open.toml;
  const Proposal clear = proposed_of("GpsTime,Northing,Easting,Height,Roll,Pitch,Azimuth\n" + row);
  EXPECT_FALSE(is_open(clear, "trajectory[1].columns")) << clear.toml;
  EXPECT_TRUE(is_open(clear, "trajectory[1].crs")) << clear.toml;
}

TEST(Proposal, SolutionsOfOneTimeAreRivals) {
  const auto solution = [](const char* name, const char* from, const char* to) {
    return file(name, std::string("{\"format\": \"RTKLIB solution\", \"from\": \"") + from + "\", \"to\": \"" + to + "\"}");
  };
  const Proposal p = propose_survey({solution("rover.pos", "2024-06-07T10:00:00.000Z", "2024-06-07T11:00:00.000Z"),
                                     solution("rover_events.pos", "2024-06-07T10:05:00.000Z", "2024-06-07T10:50:00.000Z"),
                                     solution("single.pos", "2024-06-07T10:30:00.000Z", "2024-06-07T10:40:00.000Z"),
                                     solution("later.pos", "2024-06-07T12:00:00.000Z", "2024-06-07T12:40:00.000Z")},
                                    "m");
  EXPECT_EQ(p.files, 3u) << "positions at events are no record: " << p.toml;
  EXPECT_NE(p.toml.find("rover.pos and single.pos cover the same time"), std::string::npos) << p.toml;
  EXPECT_EQ(p.toml.find("later.pos cover"), std::string::npos) << p.toml;
}

TEST(Proposal, MarksOfReceiversAreEvents) {
  const Proposal p =
      propose_survey({file("a_Timestamp.MRK", R"x({"format": "Timestamp.MRK (DJI)", "events": 12})x"),
                      file("raw.ubx", R"x({"format": "UBX (u-blox)", "events": 0})x"), file("scan.pcap", R"({"format": "pcap capture"})"),
                      file("raw.ubx.tag", R"({"format": "RTKLIB time tags"})"), file("loopstats", R"({"format": "loopstats"})")},
                     "m");
  EXPECT_NE(p.toml.find("[[event]]\nfile = \"a_Timestamp.MRK\""), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("raw.ubx: UBX (u-blox) without event marks"), std::string::npos) << p.toml;
  EXPECT_NE(p.toml.find("loopstats: a log of clocks"), std::string::npos) << p.toml;
  EXPECT_EQ(p.toml.find("[[breaklines]]"), std::string::npos) << p.toml;
}

TEST(Proposal, TimesOfAScannersFrameThatContradictTheHeader) {
  const auto proposed = [](const std::string& scale, const std::string& span) {
    const std::string facts = R"({"format": "LAS", "x": [-10, 10], "y": [-10, 10], "z": [0, 900], "time": {"scale": )";
    return propose_survey({file("frame.las", facts + '"' + scale + R"(", "span": )" + span + "}}")}, "m");
  };
  EXPECT_NE(proposed("seconds of the GPS week", "[390000000, 390003600]").toml.find("gps_adjusted"), std::string::npos);
  EXPECT_TRUE(is_open(proposed("adjusted standard GPS time", "[474006, 477600]"), "laser[1].time"));
  EXPECT_FALSE(is_open(proposed("adjusted standard GPS time", "[390000000, 390003600]"), "laser[1].time"));
}

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
