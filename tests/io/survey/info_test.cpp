// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/info.h"

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(Info, ASurveyWithItsFaults) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "survey.toml", "name = \"s\"\n[[laser]]\nfile = \"none.csv\"\n");
  const core::Value facts = describe_file(folder / "survey.toml");
  EXPECT_EQ(facts.find("name")->as_text(), "s");
  EXPECT_NE(info_text(facts).find("no such file"), std::string::npos);
}

TEST(Info, WhatThisProgramWritesAndReads) {
  const test::TemporaryFolder folder;
  const auto format = [&](const char* name, const std::string& text) {
    test::write_bytes(folder / name, text);
    const core::Value facts = describe_file(folder / name);
    EXPECT_TRUE(facts.find("warnings")->items().empty()) << info_text(facts);
    return facts.find("format")->as_text();
  };
  EXPECT_EQ(format("report.json", R"({"program": "swath 1", "survey": "s", "stages": [{"type": "readers.las"}]})"), "report of a run");
  EXPECT_NE(info_text(describe_file(folder / "report.json")).find("readers.las"), std::string::npos);
  EXPECT_EQ(format("calibration.json", R"({"calibration": {"roll": "0.1 deg"}, "sigma": {"roll": "1 arcsec"}})"), "calibration");
  EXPECT_EQ(format("p.toml", "[[stage]]\ntype = \"readers.las\"\n"), "pipeline");
  EXPECT_EQ(format("tasks.json", R"({"fingerprint": "0", "tasks": []})"), "list of tasks");
  EXPECT_EQ(format("tiles.json", R"(["a.tif", "b.tif"])"), "JSON or TOML");
  EXPECT_EQ(format("a.geojson", R"({"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": )"
                                R"({"type": "LineString", "coordinates": [[9, 48], [9.1, 48]]}}]})"),
            "GeoJSON");
  std::filesystem::rename(folder / "a.geojson", folder / "a.json");
  EXPECT_EQ(describe_file(folder / "a.json").find("format")->as_text(), "GeoJSON");
}

TEST(Info, UnknownFilesAreErrors) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "empty", "");
  test::write_bytes(folder / "zero", std::string(1000, '\0'));
  EXPECT_THROW(describe_file(folder / "empty"), core::Error);
  EXPECT_THROW(describe_file(folder / "zero"), core::Error);
  EXPECT_THROW(describe_file(folder / "none"), core::Error);
  EXPECT_THROW(describe_file(folder.path()), core::Error);
}

TEST(Info, CompressedFilesAreToBeUnpacked) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.txt.gz", std::string("\x1F\x8B\x08\x00\x00\x00", 6));
  test::write_bytes(folder / "a.zip", "PK\x03\x04 and more");
  for (const auto& [name, by] : {std::pair("a.txt.gz", "gzip"), std::pair("a.zip", "zip")}) try {
      describe_file(folder / name);
      ADD_FAILURE() << name;
    } catch (const core::Error& e) {
      EXPECT_EQ(e.what(), std::string("is compressed by ") + by);
      EXPECT_TRUE(e.hint().starts_with("unpack it first")) << e.hint();
    }
}

TEST(Info, ColumnsOfTextAreNamedAndTheOthersRead) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.csv", "t,status,r\n1,a_link,5\n2,a_link,7\n");
  const core::Value facts = describe_file(folder / "a.csv");
  EXPECT_EQ(facts.find("rows")->as_int(), 2);
  EXPECT_EQ(facts.find("columns")->items()[2].find("span")->items()[1].as_number(), 7.0);
  EXPECT_EQ(facts.find("warnings")->items()[0].as_text(), "column status holds text");
  test::write_bytes(folder / "b.csv", "a,b,c\nx,2,3\n1,2,3\n4,5,6\n");
  EXPECT_NE(describe_file(folder / "b.csv").find("warnings")->items()[0].as_text().find("reading stopped"), std::string::npos);
  test::write_bytes(folder / "b.csv", "t,r\n1,5\n2,x\n");
  EXPECT_NE(describe_file(folder / "b.csv").find("warnings")->items()[0].as_text().find("reading stopped"), std::string::npos);
}

TEST(Info, LogsOfNovatelAreNamed) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "log.txt",
                    "#BESTPOSA,COM1,0,62.5,FINESTEERING,2317,474006.000,00000000,0000,0;SOL_COMPUTED,NARROW_INT,47.9,10.5*1051ada9\n");
  try {
    describe_file(folder / "log.txt");
    FAIL() << "it is no table";
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("NovAtel log"), std::string::npos) << e.text();
  }
}

TEST(Info, CloudsOfOtherFormatsAreNamedWithTheirConversion) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n1 2 3\n");
  try {
    describe_file(folder / "a.ply");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.text().find("a PLY file"), std::string::npos) << e.text();
    EXPECT_NE(e.hint().find("pdal translate a.ply a.laz"), std::string::npos) << e.hint();
  }
  test::write_bytes(folder / "a.xyz", "1 2 3\n4 5 6\n");
  EXPECT_EQ(describe_file(folder / "a.xyz").find("format")->as_text(), "delimited text");
}

TEST(InfoReference, EveryKind) {
  SWATH_SHARED_OR_SKIP(data, "data");
  for (const auto& [name, format] : {std::pair{"tiny_survey/laser_socs.las", "LAS"},
                                     {"autzen/autzen_trim.laz", "LAZ"},
                                     {"tiny_survey/truth/sbet.out", "SBET"},
                                     {"optech_csd/sample.csd", "Optech CSD"},
                                     {"tiny_survey/laser.npy", "NumPy array"},
                                     {"tiny_survey/gnss.csv", "delimited text"},
                                     {"tiny_survey/truth/dtm_1m.tif", "GTiff"},
                                     {"rinex_rtklib/07590920.05o", "RINEX"},
                                     {"rinex_rtklib/07590920.05n", "RINEX"},
                                     {"contour_gdal/contour-gdal.geojson", "GeoJSON"},
                                     {"contour_gdal/input-dem.asc", "AAIGrid"}}) {
    const core::Value facts = describe_file(data / name);
    EXPECT_EQ(facts.find("format")->as_text(), format) << name;
    EXPECT_GT(info_text(facts).size(), 80u);
  }
  EXPECT_EQ(describe_file(data / "optech_csd/sample.csd").find("pulses")->as_int(), 1000);
  EXPECT_EQ(describe_file(data / "rinex_rtklib/07590920.05o").find("interval_s")->as_number(), 30.0);
}

}  // namespace
}  // namespace swath::io
