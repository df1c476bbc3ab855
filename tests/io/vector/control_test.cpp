// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/control.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/geodesy.h"
#include "io/survey/survey.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// Ecef coordinates have their last place at 1e-9 m; PROJ closes far below this.
constexpr double exact = 1e-6;  // m

constexpr const char* utm = "EPSG:32632";
constexpr double easting = 500100, northing = 5300200, height = 480;

/// A roof of four corners with a point of its own among them.
constexpr const char* roof =
    "name,target,x,y,z,sigma_h,sigma_v\n"
    "a,hall,500100,5300200,480,0.01,0.02\n"
    "p1,,500200,5300210,470,,\n"
    "b,hall,500130,5300200,480,0.01,0.02\n"
    "c,hall,500130,5300220,484,0.03,0.04\n"
    "d,hall,500100,5300220,484,0.01,0.02\n";

Eigen::Vector3d ecef(double e, double n, double h) { return core::Transform(core::Crs(utm), core::wgs84_ecef())({e, n, h}); }

class Control : public ::testing::Test {
 protected:
  Control() {
    survey_.folder = folder_.path();
    survey_.crs = utm;
    add("control.csv");
  }
  ControlFile& add(const std::string& name) {
    survey_.control.emplace_back();
    survey_.control.back().file = name;
    return survey_.control.back();
  }
  ControlFile& file() { return survey_.control[0]; }
  std::vector<ControlPoint> read(const std::string& text) {
    test::write_bytes(folder_ / file().file.string(), text);
    return read_control(survey_, tally_);
  }
  std::string fault(const std::string& text = {}) {
    try {
      text.empty() ? read_control(survey_, tally_) : read(text);
    } catch (const core::Error& e) {
      EXPECT_FALSE(e.hint().empty()) << e.what();
      return e.where().substr(e.where().rfind('/') + 1) + ": " + e.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

TEST_F(Control, CornersOfATargetComeTogetherAndInTheirOrder) {
  file().use = ControlUse::check;
  const auto points = read(roof);
  ASSERT_EQ(points.size(), 5u);
  const char* names[] = {"a", "b", "c", "d", "p1"};
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(points[i].name, names[i]);
    EXPECT_EQ(points[i].target, i < 4 ? "hall" : "");
    EXPECT_EQ(points[i].use, ControlUse::check);
  }
  EXPECT_LT((points[2].ecef - ecef(500130, 5300220, 484)).norm(), exact);
  EXPECT_EQ(points[2].sigma_h, 0.03);
  EXPECT_EQ(points[2].sigma_v, 0.04);
  EXPECT_EQ(points[4].sigma_h, 0.02);  // the file states none
  EXPECT_TRUE(points[4].place.ends_with("control.csv:3"));
  EXPECT_TRUE(tally_.empty());
}

TEST_F(Control, OtherColumnsAndNames) {
  file().x = "E";
  file().y = "N";
  file().z = "H";
  file().sigma_horizontal = core::Metres(0.5);
  const auto points = read("E N H\n500100 5300200 480\n500101 5300200 480\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[1].name, "2");
  EXPECT_EQ(points[1].sigma_h, 0.5);
  file().target = "roof";
  EXPECT_EQ(fault(), "control.csv: no column 'roof'; columns: E, N, H");
}

TEST_F(Control, UsualNamesOfColumnsAreUnderstood) {
  for (const char* header : {"P,N,E,Z", "Point,Northing,Easting,Elevation", "id,north,east,height", "name,y,x,h", "Name,Y [m],X [m],Z [m]",
                             "Punkt,Hochwert,Rechtswert,H\xc3\xb6he"}) {
    const auto points = read(std::string(header) + "\nA7,5300200,500100,480\n");
    ASSERT_EQ(points.size(), 1u) << header;
    EXPECT_EQ(points[0].name, "A7") << header;
    EXPECT_NEAR((points[0].ecef - ecef(500100, 5300200, 480)).norm(), 0.0, 1e-3) << header;
  }
  EXPECT_EQ(fault("P,N,E,easting,Z\nA7,5300200,500100,500100,480\n"), "control.csv: no column 'x'; columns: P, N, E, easting, Z");
  EXPECT_EQ(fault("P,N,Q,Z\nA7,5300200,500100,480\n"), "control.csv: no column 'x'; columns: P, N, Q, Z");
}

TEST_F(Control, AFileWithoutAHeaderByTheNumbersOfItsColumns) {
  EXPECT_EQ(fault("A7,5300200,500100,480\nA8,5300200,500100,480\n"),
            "control.csv: no column 'x'; the file has no header; columns are numbered 1 to 4");
  file().name = "1", file().x = "3", file().y = "2", file().z = "4";
  const auto points = read("A7,5300200,500100,480\nA8,5300200,500100,480\n");
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].name, "A7");
  EXPECT_NEAR((points[1].ecef - ecef(500100, 5300200, 480)).norm(), 0.0, 1e-3);
}

TEST_F(Control, HeightsFollowTheCrs) {
  survey_.height_unit = core::Metres(0.3048);
  const double feet = height / 0.3048;
  const std::string row = "x,y,z\n500100,5300200," + std::to_string(feet) + "\n";
  EXPECT_LT((read(row)[0].ecef - ecef(easting, northing, height)).norm(), 1e-5);  // six decimals of a foot
  // A vertical part has its own unit; geocentric coordinates have no heights.
  file().crs = "EPSG:4978";
  const Eigen::Vector3d p = ecef(easting, northing, height);
  EXPECT_LT((read("x,y,z\n" + std::to_string(p.x()) + "," + std::to_string(p.y()) + "," + std::to_string(p.z()) + "\n")[0].ecef - p).norm(),
            1e-5);
  file().crs = "EPSG:4326";
  survey_.height_unit.reset();
  const core::Geodetic g = core::geodetic_of(read("x,y,z\n9,47.5,480\n")[0].ecef);
  EXPECT_NEAR(g.latitude, 47.5 * core::degree, 1e-12);
  EXPECT_NEAR(g.height, 480, exact);
}

TEST_F(Control, HeightsBesideCloudsCountInTheUnitOfTheMap) {
  constexpr double foot = 1200.0 / 3937.0;
  survey_.points.emplace_back().file = "a.laz";
  EXPECT_LT((read("x,y,z\n500100,5300200,480\n")[0].ecef - ecef(easting, northing, height)).norm(), exact);
  const auto in_feet = [&] {
    return read("x,y,z\n" + std::to_string(easting / foot) + "," + std::to_string(northing / foot) + "," + std::to_string(height / foot) +
                "\n");
  };
  file().crs = "+proj=utm +zone=32 +datum=WGS84 +units=us-ft";
  EXPECT_LT((in_feet()[0].ecef - ecef(easting, northing, height)).norm(), 1e-5);  // six decimals of a foot
  file().crs.clear();
  survey_.crs = "+proj=utm +zone=32 +datum=WGS84 +units=us-ft";
  EXPECT_LT((in_feet()[0].ecef - ecef(easting, northing, height)).norm(), 1e-5);
}

/// A table with `n` right points.
std::string right_points(int n) {
  std::string out = "x,y,z,target\n";
  for (int i = 0; i < n; ++i) out += std::to_string(500100 + i) + ",5300200,480,\n";
  return out;
}

TEST_F(Control, ImpossibleCoordinatesAreLeftOutAndCounted) {
  constexpr const char* what = "control points with an impossible coordinate, left out";
  for (const char* bad : {"500100,5300200,,", ",5300200,480,", "500100,5300200,nan,", "inf,5300200,480,", "1e9,5300200,480,",
                          "500100,1e300,480,", "500100,1e400,480,"}) {
    tally_ = {};
    EXPECT_EQ(read(right_points(9) + bad + "\n").size(), 9u) << bad;
    EXPECT_EQ(tally_.of(what), 1u) << bad;
  }
  // The plane of a target needs all of its corners.
  EXPECT_EQ(read(right_points(9) + "500100,5300200,480,r\n500110,5300200,480,r\n500110,5300210,480,r\n500100,nan,480,r\n").size(), 9u);
}

TEST_F(Control, RowsWithoutAHeightAreLeftOutHoweverMany) {
  std::string text = right_points(5);
  for (const char* none : {"-9999", "-32767", "-32768", "-99999"}) text += "500100,5300200," + std::string(none) + ",\n";
  EXPECT_EQ(read(text).size(), 5u);
  EXPECT_EQ(tally_.of("control points without a height, left out"), 4u);
  tally_ = {};
  EXPECT_EQ(read(right_points(9) + "500100,5300200,-12345,\n500100,5300200,1e6,\n").size(), 9u);
  EXPECT_EQ(tally_.of("control points with an impossible coordinate, left out"), 2u);
  EXPECT_NE(fault(right_points(2) + "500100,5300200,48000,\n").find("control.csv:4: the height is 48000, which no ground has"),
            std::string::npos);
}

TEST_F(Control, AFileOfImpossibleCoordinatesIsRefused) {
  std::string text = right_points(9);
  for (int i = 0; i < 4; ++i) text += "500100,nan,480,\n";
  EXPECT_EQ(fault(text), "control.csv:11: a coordinate is empty or not finite");
  file().crs = "EPSG:4326";
  EXPECT_NE(fault(right_points(20)).find("control.csv:2: x 500100, y 5300200, z 480 is not a place of WGS 84"), std::string::npos)
      << fault(right_points(20));
}

TEST_F(Control, FaultsNameTheirLine) {
  EXPECT_EQ(fault("name,x,y\na,1,2\n"), "control.csv: no column 'z'; columns: name, x, y");
  EXPECT_EQ(fault("x,y,z,sigma_v\n500100,5300200,480,0\n"), "control.csv:2: the sigma of height is 0 m, which is none above zero");
  EXPECT_EQ(fault("x,y,z,target\n500100,5300200,480,r\n500100,5300210,480,r\n"),
            "control.csv:2: target 'r' has 2 corners, at least 3 are needed");
  EXPECT_EQ(fault("x,y,z,target\n500100,5300200,480,r\n500100,5300210,480,r\n500100.01,5300205,480,r\n"),
            "control.csv:2: the corners of target 'r' lie in one line (within 0.01 m of it)");
  EXPECT_EQ(fault("x,y,z,target\n500100,5300200,480,r\n500100,5300200,480,r\n500100,5300200,480,r\n"),
            "control.csv:2: the corners of target 'r' lie in one line (within 0 m of it)");
  survey_.crs.clear();
  EXPECT_EQ(fault("x,y,z\n500100,5300200,480\n"), "control.csv: the CRS of the control is not known");
  file().file = "none.csv";
  EXPECT_NE(fault().find("none.csv"), std::string::npos);
}

TEST_F(Control, NamesThatRepeatAreCountedAndTargetsInTwoFilesRefused) {
  read("name,x,y,z\np,500100,5300200,480\np,500101,5300200,480\nq,500101,5300200,480\n");
  EXPECT_EQ(tally_.of("control points whose name stands more than once"), 1u);
  read(roof);
  add("more.csv").use = ControlUse::check;
  test::write_bytes(folder_ / "more.csv", roof);
  EXPECT_NE(fault().find("more.csv:2: target 'hall' stands in "), std::string::npos);
  survey_.control.clear();
  EXPECT_TRUE(read_control(survey_, tally_).empty());
}

/// Makes a GeoPackage; `shapes` as WKT with name, target and sigma_h.
struct Shape {
  const char *wkt, *name, *target;
  double sigma_h;
};
void make_geopackage(const std::filesystem::path& file, const std::string& crs, const std::vector<Shape>& shapes) {
  const GdalMessages registered;
  GDALDataset* set = GetGDALDriverManager()->GetDriverByName("GPKG")->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  OGRSpatialReference srs;
  if (!crs.empty()) srs.SetFromUserInput(crs.c_str());
  srs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRLayer* layer = set->CreateLayer("surveyed", crs.empty() ? nullptr : &srs, wkbUnknown, nullptr);
  OGRFieldDefn name("name", OFTString), target("target", OFTString), sigma("sigma_h", OFTReal), text("text", OFTString);
  for (OGRFieldDefn* f : {&name, &target, &sigma, &text}) ASSERT_EQ(layer->CreateField(f), OGRERR_NONE);
  for (const Shape& s : shapes) {
    OGRFeature feature(layer->GetLayerDefn());
    if (*s.name) feature.SetField("name", s.name);
    if (*s.target) feature.SetField("target", s.target);
    if (s.sigma_h != 0) feature.SetField("sigma_h", s.sigma_h);
    OGRGeometry* shape = nullptr;
    if (*s.wkt) {
      ASSERT_EQ(OGRGeometryFactory::createFromWkt(s.wkt, nullptr, &shape), OGRERR_NONE);
    }
    if (shape) feature.SetGeometryDirectly(shape);
    ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  }
  GDALClose(set);
}

class GeoPackageControl : public Control {
 protected:
  GeoPackageControl() { file().file = "a.gpkg"; }
  void make(const std::string& crs, const std::vector<Shape>& shapes) {
    std::filesystem::remove(folder_ / "a.gpkg");
    make_geopackage(folder_ / "a.gpkg", crs, shapes);
  }
};

TEST_F(GeoPackageControl, HeightsCountFromWhatTheFilesOwnCrsSays) {
  const std::vector<Shape> point{{"POINT Z (500200 5300210 470)", "p1", "", 0}};
  make("EPSG:32632+5773", point);  // EGM96
  EXPECT_EQ(read_control(survey_, tally_).at(0).heights, core::Heights::vertical);
  make(utm, point);
  EXPECT_EQ(read_control(survey_, tally_).at(0).heights, core::Heights::unknown);
  file().crs = "EPSG:32632+ellipsoidal";
  EXPECT_EQ(read_control(survey_, tally_).at(0).heights, core::Heights::ellipsoidal);
}

constexpr const char* hall = "POLYGON Z ((500100 5300200 480,500130 5300200 480,500130 5300220 484,500100 5300220 484,500100 5300200 480))";

TEST_F(GeoPackageControl, PointsAndPolygons) {
  survey_.crs = "EPSG:4978";  // the file's own goes before it
  make(utm, {{hall, "hall", "", 0.05},
             {"POINT Z (500200 5300210 470)", "p1", "", 0},
             {hall, "", "", 0},
             {"POINT Z (500300 5300210 470)", "e1", "east", 0},
             {"POINT Z (500310 5300210 470)", "e2", "east", 0},
             {"MULTIPOINT Z ((500310 5300220 471))", "e3", "east", 0},
             {"", "nothing", "", 0}});
  const auto points = read_control(survey_, tally_);
  ASSERT_EQ(points.size(), 12u);
  EXPECT_EQ(points[3].target, "hall");
  EXPECT_EQ(points[3].name, "hall 4");
  EXPECT_EQ(points[3].sigma_h, 0.05);
  EXPECT_EQ(points[3].sigma_v, 0.02);
  EXPECT_LT((points[3].ecef - ecef(500100, 5300220, 484)).norm(), exact);
  EXPECT_EQ(points[4].name, "p1");
  EXPECT_EQ(points[4].target, "");
  EXPECT_TRUE(points[4].place.ends_with("a.gpkg: layer surveyed, feature 2"));
  EXPECT_EQ(points[5].target, "surveyed 3");
  EXPECT_EQ(points[11].name, "e3");
  EXPECT_EQ(points[11].target, "east");
  EXPECT_EQ(tally_.of("control features without a geometry, left out"), 1u);
  // What the survey states goes before the file.
  file().crs = "EPSG:32633";
  EXPECT_GT((read_control(survey_, tally_)[4].ecef - points[4].ecef).norm(), 1e5);
}

TEST_F(GeoPackageControl, AFileWithoutACrsTakesTheSurveys) {
  make("", {{"POINT Z (500200 5300210 470)", "p1", "", 0}});
  EXPECT_LT((read_control(survey_, tally_)[0].ecef - ecef(500200, 5300210, 470)).norm(), exact);
  survey_.crs.clear();
  EXPECT_EQ(fault(), "a.gpkg: the CRS of the control is not known");
}

TEST_F(GeoPackageControl, HeightsThatTheFileDoesNotDefineAreNotGuessed) {
  survey_.crs = "EPSG:32632+5773";
  make(utm, {{"POINT Z (500200 5300210 470)", "p1", "", 0}});
  EXPECT_NE(fault().find("does not say what its heights are"), std::string::npos);
  file().crs = utm;
  EXPECT_NE(fault().find("does not say what its heights are"), std::string::npos);
  file().crs = utm + std::string("+ellipsoidal");
  EXPECT_LT((read_control(survey_, tally_)[0].ecef - ecef(500200, 5300210, 470)).norm(), exact);
}

TEST_F(GeoPackageControl, FaultsNameTheirFeature) {
  const auto refused = [&](const Shape& shape) {
    make(utm, {shape});
    return fault();
  };
  EXPECT_EQ(refused({"POINT (500200 5300210)", "", "", 0}), "a.gpkg: layer surveyed, feature 1: the point has no height");
  EXPECT_EQ(refused({"POLYGON ((0 0,1 0,1 1,0 0))", "", "", 0}), "a.gpkg: layer surveyed, feature 1: the polygon has no heights");
  EXPECT_EQ(refused({"LINESTRING Z (0 0 0,1 0 0)", "", "", 0}),
            "a.gpkg: layer surveyed, feature 1: the feature is a LINESTRING, not a point or a polygon");
  EXPECT_EQ(refused({"MULTIPOINT Z ((0 0 0),(1 0 0))", "", "", 0}),
            "a.gpkg: layer surveyed, feature 1: the feature has 2 parts, one is needed");
  EXPECT_EQ(refused({"POINT Z (500200 5300210 470)", "", "", -1}),
            "a.gpkg: layer surveyed, feature 1: the sigma of easting and northing is -1 m, which is none above zero");
  make(utm, {{hall, "hall", "", 0}, {hall, "hall", "", 0}});
  EXPECT_NE(fault().find("feature 2: target 'hall' stands a second time"), std::string::npos);
  file().z = "text";
  EXPECT_EQ(fault(), "a.gpkg: layer surveyed: attribute 'text' holds no numbers");
  file().z = "level";
  EXPECT_EQ(fault(), "a.gpkg: layer surveyed: no attribute 'level'; attributes: name, target, sigma_h, text");
  file().file = "none.gpkg";
  EXPECT_NE(fault().find("none.gpkg: cannot read the GeoPackage"), std::string::npos);
}

TEST_F(Control, PointsWithoutANameAreKnownAsSuch) {
  const auto named = read("name,x,y,z\nmark,500100,5300200,480\n,500120,5300200,481\n");
  ASSERT_EQ(named.size(), 2u);
  EXPECT_TRUE(named[0].is_named && !named[1].is_named);
  EXPECT_EQ(named[1].name, "2");
  EXPECT_FALSE(read("x,y,z\n500100,5300200,480\n")[0].is_named);
}

TEST_F(Control, FilesOfPlanOrHeightsAloneAreForImages) {
  file().kind = ControlKind::z;
  add("full.csv").use = ControlUse::check;
  test::write_bytes(folder_ / "control.csv", "name,x,y,z\nbench,500100,5300200,480\n");
  test::write_bytes(folder_ / "full.csv", "name,x,y,z\nmark,500120,5300200,481\n");
  const auto laser = read_control(survey_, tally_), images = read_image_control(survey_, tally_);
  ASSERT_EQ(laser.size(), 1u);
  EXPECT_EQ(laser[0].name, "mark");
  ASSERT_EQ(images.size(), 2u);
  EXPECT_TRUE(images[0].kind == ControlKind::z && images[1].kind == ControlKind::xyz);
}

}  // namespace
}  // namespace swath::io
