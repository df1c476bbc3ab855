// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/clouds.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/las/las_crs.h"
#include "io/las/las_writer.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

/// A folder of clouds, worked in.
class Clouds : public ::testing::Test {
 protected:
  Clouds() : before_(fs::current_path()) { fs::current_path(folder_.path()); }
  ~Clouds() override { fs::current_path(before_); }

  static fs::path cloud(const fs::path& name, const std::string& crs, double x = 500000.0, double y = 5400000.0) {
    io::LasHeader header = test::sample_header(6);
    header.offset = {x, y, -100.0};
    if (!crs.empty()) io::add_las_wkt(header, core::Crs(crs).wkt1());
    if (name.has_parent_path()) fs::create_directories(name.parent_path());
    test::write_sample(name, header, test::sample_points(header, 100), 1);
    return name;
  }
  template <class F>
  static core::Error fault(F&& call) {
    try {
      call();
    } catch (const core::Error& e) {
      return e;
    }
    ADD_FAILURE() << "nothing was refused";
    return core::Error("");
  }
  static std::string fault_of(const std::vector<fs::path>& files, const std::string& crs = {}) {
    const core::Error e = fault([&] { cloud_survey(files, crs); });
    EXPECT_EQ(e.code(), core::Exit::bad_usage);
    return e.text();
  }

  fs::path before_;
  test::TemporaryFolder folder_;
};

TEST_F(Clouds, FilesFoldersAndPatternsEachOnce) {
  for (const char* name : {"tiles/b.laz", "tiles/a.LAS", "other.laz"}) cloud(name, "");
  test::write_bytes("tiles/readme.txt", "not a cloud");
  const std::vector<fs::path> expected{"other.laz", "tiles/a.LAS", "tiles/b.laz"};
  EXPECT_EQ(cloud_files({"other.laz", "tiles", "./tiles/b.laz"}), expected);
  EXPECT_EQ(cloud_files({"*.laz", "tiles/*.[lL][aA][sSzZ]"}), expected);
  EXPECT_EQ(cloud_files({"ti*"}), (std::vector<fs::path>{"tiles/a.LAS", "tiles/b.laz"})) << "a pattern may match folders";
}

TEST_F(Clouds, AnIndexStandsForItsFiles) {
  cloud("tile/ept-data/0-0-0-0.laz", "");
  test::write_bytes("tile/ept.json", "{}");
  EXPECT_EQ(cloud_files({"tile"}), std::vector<fs::path>{"tile/ept.json"});
  EXPECT_EQ(cloud_name({"tile/ept.json"}), "tile");
  test::write_bytes("all.vpc", "{}");
  const core::Value survey = cloud_survey(cloud_files({"all.vpc"}), "");
  EXPECT_EQ(survey.find("points")->items()[0].find("crs"), nullptr) << "its reader finds the CRS of its files";
}

TEST_F(Clouds, NamesThatStandForNothingAreOneError) {
  fs::create_directory("empty");
  fs::create_symlink("loop", "loop");
  const auto text = [&](const std::string& name) { return fault([&] { cloud_files({name}); }).text(); };
  EXPECT_NE(text("away.laz").find("away.laz: no such file or folder"), std::string::npos);
  EXPECT_NE(text("empty").find("holds no LAS or LAZ file"), std::string::npos);
  EXPECT_NE(text("empty").find("name the files, or another folder"), std::string::npos);
  cloud("above/one/a.laz", "");
  EXPECT_NE(text("above").find("its subfolders hold 1: name 'above/*/*.[lL][aA][sSzZ]'"), std::string::npos) << text("above");
  EXPECT_EQ(cloud_files({"above/*/*.[lL][aA][sSzZ]"}).size(), 1u);
  EXPECT_NE(text("away*.laz").find("no file matches the pattern"), std::string::npos);
  EXPECT_NE(text("nowhere/*.laz").find("no such folder"), std::string::npos) << text("nowhere/*.laz");
  EXPECT_NE(text("loop/*.laz").find("cannot read a folder of the pattern"), std::string::npos) << text("loop/*.laz");
}

TEST_F(Clouds, OneCrsForAll) {
  const auto a = cloud("a.laz", "EPSG:32632"), b = cloud("b.laz", "EPSG:32632");
  const core::Value survey = cloud_survey({a, b}, "");
  EXPECT_EQ(survey.find("crs"), nullptr) << "the clouds' own";
  ASSERT_EQ(survey.find("points")->items().size(), 2u);
  EXPECT_EQ(survey.find("points")->items()[0].find("crs"), nullptr);
  EXPECT_EQ(survey.find("points")->items()[1].find("file")->as_text(), (fs::current_path() / "b.laz").string());
}

TEST_F(Clouds, ACrsThatIsNotStatedIsAskedFor) {
  const auto bare = cloud("bare.laz", ""), known = cloud("known.laz", "EPSG:25832");
  EXPECT_NE(fault_of({bare}).find("states no CRS"), std::string::npos);
  EXPECT_NE(fault_of({bare}).find("--crs EPSG:25832"), std::string::npos);
  const core::Value survey = cloud_survey({bare, known}, "EPSG:25832");
  EXPECT_EQ(survey.find("crs")->as_text(), "EPSG:25832");
  EXPECT_EQ(survey.find("points")->items()[0].find("crs")->as_text(), "EPSG:25832");
  EXPECT_EQ(survey.find("points")->items()[1].find("crs"), nullptr) << "it states its own";
  EXPECT_NE(fault_of({bare}, "EPSG:1").find("--crs EPSG:1"), std::string::npos);
}

TEST_F(Clouds, OpenHeightsAreNamedInWordsOfTheCommand) {
  const auto open = cloud("open.laz", "EPSG:25832"), known = cloud("known.laz", "EPSG:25832+7837");
  std::string said = fault_of({open}, "EPSG:25832+7837");
  EXPECT_NE(said.find("open.laz: its CRS, ETRS89 / UTM zone 32N, does not state what its heights count from"), std::string::npos) << said;
  EXPECT_NE(said.find("name --crs EPSG:25832, and the heights stay as they are"), std::string::npos) << said;
  said = fault_of({known}, "EPSG:25832");
  EXPECT_NE(said.find("known.laz: its heights are "), std::string::npos) << said;
  EXPECT_NE(said.find("hint: name the vertical part, too: --crs EPSG:25832+7837"), std::string::npos) << said;
  EXPECT_NO_THROW(cloud_survey({known}, "EPSG:25832+7837"));
  EXPECT_NO_THROW(cloud_survey({open}, "EPSG:25833"));
}

TEST_F(Clouds, APrjBesideACloudIsMentioned) {
  const auto bare = cloud("bare.laz", "");
  test::write_bytes("bare.prj", core::Crs("EPSG:2056").wkt1());
  EXPECT_NE(fault_of({bare}).find("bare.prj beside it states CH1903+ / LV95: name its CRS: --crs EPSG:2056"), std::string::npos)
      << fault_of({bare});
  test::write_bytes("bare.prj", R"(PROJCS["CH1903+_LV95",GEOGCS["GCS_CH1903+",DATUM["D_CH1903+",SPHEROID["Bessel_1841",6377397.155,)"
                                R"(299.1528128]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],)"
                                R"(PROJECTION["Hotine_Oblique_Mercator_Azimuth_Center"],PARAMETER["False_Easting",2600000.0],)"
                                R"(PARAMETER["False_Northing",1200000.0],PARAMETER["Scale_Factor",1.0],PARAMETER["Azimuth",90.0],)"
                                R"(PARAMETER["Longitude_Of_Center",7.439583333333333],PARAMETER["Latitude_Of_Center",46.95240555555556],)"
                                R"(UNIT["Meter",1.0]])");
  EXPECT_NE(fault_of({bare}).find("bare.prj beside it states CH1903+ / LV95: name its CRS: --crs EPSG:2056"), std::string::npos)
      << "WKT of ESRI has no codes: " << fault_of({bare});
  const std::string site = core::Crs("+proj=tmerc +lat_0=47 +lon_0=11 +x_0=1000 +y_0=2000 +ellps=GRS80 +units=m").wkt1();
  test::write_bytes("bare.prj", site);
  EXPECT_NE(fault_of({bare}).find("--crs EPSG:CODE"), std::string::npos) << fault_of({bare});
  test::write_bytes("bare.prj", "nothing that is understood");
  EXPECT_EQ(fault_of({bare}).find("beside"), std::string::npos) << fault_of({bare});
}

TEST_F(Clouds, DifferentCrssAndUnitsAreNamed) {
  const auto a = cloud("a.laz", "EPSG:32632"), zone = cloud("zone.laz", "EPSG:32633"), feet = cloud("feet.laz", "EPSG:2994");
  EXPECT_NE(fault_of({a, zone}).find("different CRSs"), std::string::npos);
  EXPECT_NE(fault_of({a, zone}).find("UTM zone 33N"), std::string::npos);
  EXPECT_NE(fault_of({a, feet}).find("different units and CRSs"), std::string::npos);
  EXPECT_NE(fault_of({a, feet}).find("(foot)"), std::string::npos) << fault_of({a, feet});
  EXPECT_NO_THROW(cloud_survey({a, zone}, "EPSG:32632")) << "the CRS of the products is named: others are transformed";
}

TEST_F(Clouds, DegreesNeedAMapProjection) {
  const auto degrees = cloud("degrees.laz", "EPSG:4326", 11.0, 48.0);
  EXPECT_NE(fault_of({degrees}).find("map projection"), std::string::npos);
  EXPECT_NE(fault_of({degrees}).find("EPSG:32"), std::string::npos) << fault_of({degrees});
}

/// Two points in degrees.
fs::path pair(const fs::path& name, const std::string& crs, double x0, double x1, double latitude) {
  core::Block b;
  core::resize(b, 2);
  b.x = {x0, x1};
  b.y = {latitude, latitude};
  b.z = {10.0, 10.0};
  io::LasWriteOptions o;
  o.crs_wkt = core::Crs(crs).wkt1();
  o.scale = {1e-7, 1e-7, 1e-3};
  io::LasWriter writer(name, o);
  writer.write(b);
  writer.finish();
  return name;
}

TEST_F(Clouds, TheProposedZoneIsThatOfThePlace) {
  EXPECT_NE(fault_of({pair("munich.las", "EPSG:4326", 11.0, 11.1, 48.0)}).find("--crs EPSG:32632"), std::string::npos);
  EXPECT_NE(fault_of({pair("etrs.las", "EPSG:4258", 11.0, 11.1, 48.0)}).find("--crs EPSG:25832"), std::string::npos);
  const std::string fiji = fault_of({pair("fiji.las", "EPSG:4326", -179.9999, 179.9999, -17.0)});
  EXPECT_TRUE(fiji.find("--crs EPSG:32760") != std::string::npos || fiji.find("--crs EPSG:32701") != std::string::npos) << fiji;
}

TEST_F(Clouds, AClassIsFoundInAnyFile) {
  for (const bool ground : {false, true}) {
    core::Block b;
    core::resize(b, 3);
    core::add_columns(b, {core::Column::classification});
    b.x = b.y = b.z = {1.0, 2.0, 3.0};
    b.classification = {1, 1, static_cast<std::uint8_t>(ground ? 2 : 1)};
    io::LasWriter writer(ground ? "ground.laz" : "bare.laz", io::LasWriteOptions{});
    writer.write(b);
    writer.finish();
  }
  EXPECT_FALSE(has_class({"bare.laz"}, 2));
  EXPECT_TRUE(has_class({"bare.laz", "ground.laz"}, 2));
  EXPECT_TRUE(has_class({"all.vpc"}, 2)) << "not looked into";
}

TEST_F(Clouds, ProductsHaveANameOfTheirOwn) {
  EXPECT_EQ(cloud_name({"in/flight.copc.laz"}), "flight");
  EXPECT_EQ(cloud_name({"in/a.laz", "in/b.laz"}), "in");
  EXPECT_EQ(cloud_name({"in/a.laz", "out/b.laz"}), "clouds");
  const std::vector<fs::path> one{"flight.laz"};
  EXPECT_EQ(proposed_output(one, "dtm"), "flight_dtm");
  fs::create_directory("flight_dtm");
  EXPECT_EQ(proposed_output(one, "dtm"), "flight_dtm") << "an empty folder is free";
  test::write_bytes("flight_dtm/thesis.tex", "years of work");
  EXPECT_NE(fault([&] { proposed_output(one, "dtm"); }).text().find("--output"), std::string::npos);
  test::write_bytes("flight_dtm/report.json", "{}");
  EXPECT_EQ(proposed_output(one, "dtm"), "flight_dtm") << "an earlier run";
}

}  // namespace
}  // namespace swath::pipeline
