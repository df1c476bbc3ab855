// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/check_columns.h"

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

class CheckPointColumns : public ::testing::Test {
 protected:
  /// A cloud of UTM 32 whose first point is near the place.
  fs::path cloud(double x = 512784.0, double y = 5403676.0) {
    io::LasHeader header = test::sample_header(6);
    header.offset = {x, y, -100.0};
    io::add_las_wkt(header, core::Crs("EPSG:32632").wkt1());
    test::write_sample(folder_ / "cloud.laz", header, test::sample_points(header, 100), 1);
    return folder_ / "cloud.laz";
  }
  CheckColumns columns(const std::string& text, const std::string& stated = {}, const std::string& check_crs = {}) {
    test::write_bytes(folder_ / "marks.csv", text);
    return check_columns(folder_ / "marks.csv", stated, {clouds_, "", check_crs});
  }
  static std::string list(const CheckColumns& c) { return c.name + "," + c.x + "," + c.y + "," + c.z; }
  std::string fault(const std::string& text, const std::string& stated = {}) {
    try {
      columns(text, stated);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.code(), core::Exit::bad_usage);
      EXPECT_NE(e.text().find("--check-columns"), std::string::npos) << e.text();
      EXPECT_EQ(e.text().find("[[control]]"), std::string::npos) << e.text();
      return e.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  std::vector<fs::path> clouds_{cloud()};
};

TEST_F(CheckPointColumns, NamesOfAHeaderAreLeftToTheReader) {
  for (const char* header :
       {"name,x,y,z", "Name,X [m],Y [m],Z [m]", "Punkt,Rechtswert,Hochwert,H\xc3\xb6he", "Pkt,Ost,Nord,H", "id,E,N,Alt"})
    EXPECT_FALSE(columns(std::string(header) + "\nP1,512784.470,5403676.430,348.770\n").are_stated()) << header;
}

TEST_F(CheckPointColumns, WithoutAHeaderTheOrderIsTheOneThatFitsTheCloud) {
  const CheckColumns xyz = columns("P1,512784.470,5403676.430,348.770\nP2,512790.1,5403680.2,348.1\n");
  EXPECT_EQ(list(xyz), "1,2,3,4");
  EXPECT_NE(xyz.note.find("column 2 is taken as easting, 3 as northing, 4 as height, 1 as name: so 2 of 2 points lie in or near the cloud"),
            std::string::npos)
      << xyz.note;
  EXPECT_EQ(list(columns("1,5403676.430,512784.470,348.770,MON\n2,5403680.2,512790.1,,\n")), "1,3,2,4");
  EXPECT_EQ(list(columns("512784.470 5403676.430 348.770\n")), ",1,2,3");
}

TEST_F(CheckPointColumns, AnotherCrsOfTheCheckPointsCounts) {
  // 9.17 E, 48.78 N is near the cloud in UTM 32.
  EXPECT_EQ(list(columns("P1,48.7853,9.1739,348.8\n", "", "EPSG:4326")), "1,3,2,4");
}

TEST_F(CheckPointColumns, WhereNoneOrBothOrdersFitTheColumnsMustBeStated) {
  EXPECT_EQ(
      fault("P1,3512784.470,5403676.430,348.770\n"),
      "the file has no header, and no two columns side by side put the points in or near the cloud (are they in another CRS? --check-crs "
      "names it)");
  clouds_ = {cloud(500.0, 600.0)};
  EXPECT_EQ(fault("P1,510,610,3\n"),
            "the file has no header, and its points lie in or near the cloud by more than one order of the columns");
  EXPECT_EQ(list(columns("P1,510,610,3\n", "1,3,2,4")), "1,3,2,4");
}

TEST_F(CheckPointColumns, StatedOnesAreThoseOfTheFile) {
  const std::string text = "Marke;Y-Koordinate;X-Koordinate;NHN\nP1;512784.470;5403676.430;348.770\n";
  EXPECT_EQ(fault(text),
            "the columns of easting, northing and height are not known by their names; columns: Marke, Y-Koordinate, X-Koordinate, NHN");
  EXPECT_EQ(list(columns(text, "Marke,Y-Koordinate,3,NHN")), "Marke,Y-Koordinate,3,NHN");
  EXPECT_EQ(list(columns(text, "2,3,4")), ",2,3,4");
  EXPECT_EQ(fault(text, "Mark,2,3,4"), "no column 'Mark'; columns: Marke, Y-Koordinate, X-Koordinate, NHN");
  EXPECT_EQ(fault(text, "1,2"), "is no list of three or four columns");
}

}  // namespace
}  // namespace swath::pipeline
