// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/gdal_door.h"

#include <cpl_conv.h>
#include <cpl_error.h>
#include <gdal_priv.h>

#include "core/error.h"
#include "core/geo/crs.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(GdalDoor, FailuresAreCaughtAndNamed) {
  const GdalMessages messages;
  CPLError(CE_Warning, CPLE_AppDefined, "a warning");
  EXPECT_FALSE(messages.failed());
  EXPECT_EQ(messages.text(), "a warning");
  CPLError(CE_Failure, CPLE_FileIO, "write: No space left on device");
  CPLError(CE_Failure, CPLE_FileIO, "a second failure");
  ASSERT_TRUE(messages.failed());
  try {
    messages.check_written("a.tif");
    FAIL();
  } catch (const core::SystemError& e) {
    EXPECT_EQ(e.where(), "a.tif");
    EXPECT_EQ(std::string(e.what()), "cannot write: write: No space left on device");
    EXPECT_NE(e.hint().find("disk is full"), std::string::npos);
  }
  EXPECT_THROW(messages.check("cannot read", "a.tif"), core::Error);
}

TEST(GdalDoor, TextIsANumberAsAWholeOrNotAtAll) {
  const GdalMessages registered;
  OGRFeatureDefn defn("table");
  defn.Reference();
  defn.SetGeomType(wkbNone);
  OGRFieldDefn text("text", OFTString), real("real", OFTReal);
  defn.AddFieldDefn(&text);
  defn.AddFieldDefn(&real);
  {
    OGRFeature feature(&defn);
    EXPECT_FALSE(number_of(feature, 0) || number_of(feature, 1) || number_of(feature, -1));
    feature.SetField(1, 401.5);
    EXPECT_EQ(number_of(feature, 1), 401.5);
    for (const char* good : {"401.5", " 401.5 ", "+401.5", "4.015e2"}) {
      feature.SetField(0, good);
      EXPECT_EQ(number_of(feature, 0), 401.5) << good;
    }
    for (const char* bad : {"401,5", "n/a", "", "  ", "401.5 m"}) {
      feature.SetField(0, bad);
      EXPECT_FALSE(number_of(feature, 0)) << bad;
    }
  }
  defn.Dereference();
}

TEST(GdalDoor, SettingsLastAsLongAsTheirObject) {
  const GdalSetting outer("SWATH_TEST_SETTING", "1");
  {
    const GdalSetting inner("SWATH_TEST_SETTING", "2");
    EXPECT_STREQ(CPLGetConfigOption("SWATH_TEST_SETTING", ""), "2");
  }
  EXPECT_STREQ(CPLGetConfigOption("SWATH_TEST_SETTING", ""), "1");
}

TEST(GdalDoor, FactsOfProjectedCompoundFeetAndDegrees) {
  const CrsFacts utm = crs_facts("EPSG:32632");
  EXPECT_EQ(utm.unit, "m");
  EXPECT_EQ(utm.vertical_unit, "m");
  EXPECT_EQ(utm.vertical_name, "height system not stated");
  EXPECT_FALSE(utm.geographic);

  const CrsFacts compound = crs_facts("EPSG:25832+7837");
  EXPECT_EQ(compound.unit, "m");
  EXPECT_EQ(compound.vertical_name, core::Crs("EPSG:25832+7837").vertical_name());
  EXPECT_NE(compound.wkt.find("COMPOUNDCRS"), std::string::npos);
  EXPECT_EQ(compound.horizontal_wkt.find("COMPOUNDCRS"), std::string::npos);
  EXPECT_NE(compound.horizontal_wkt.find("25832"), std::string::npos);

  const CrsFacts feet = crs_facts("EPSG:2992");  // Oregon Lambert, international feet, without a vertical part
  EXPECT_EQ(feet.unit, "ft");
  EXPECT_EQ(feet.vertical_unit, "unknown unit");
  const CrsFacts mixed = crs_facts("EPSG:2263+6360");  // New York Long Island (ftUS) + NAVD88 (ftUS)
  EXPECT_EQ(mixed.unit, "ftUS");
  EXPECT_EQ(mixed.vertical_unit, "ftUS");
  EXPECT_EQ(crs_facts("EPSG:2263+5703").vertical_unit, "m");

  const CrsFacts ellipsoidal = crs_facts("EPSG:32632+ellipsoidal");
  EXPECT_EQ(ellipsoidal.vertical_name, "ellipsoidal height");
  EXPECT_EQ(ellipsoidal.horizontal_wkt.find("ellipsoidal"), std::string::npos) << ellipsoidal.horizontal_wkt;

  EXPECT_TRUE(crs_facts("EPSG:4326").geographic);
  EXPECT_EQ(crs_facts("EPSG:4326").unit, "degree");
  EXPECT_EQ(crs_facts("EPSG:4326").vertical_unit, "m");
  EXPECT_EQ(crs_facts("EPSG:32632").axis_mapping, "1,2");
  EXPECT_EQ(crs_facts("EPSG:4326").axis_mapping, "2,1");
  EXPECT_EQ(crs_facts("EPSG:25832+EPSG:7837").wkt, compound.wkt);
  EXPECT_EQ(crs_facts(compound.wkt).wkt, compound.wkt);
  EXPECT_TRUE(crs_facts("").empty);
  EXPECT_THROW(crs_facts("EPSG:1"), core::Error);
  EXPECT_THROW(crs_facts("somewhere"), core::Error);
}

TEST(GdalDoor, OnlyFilesOfKnownFormatsAreOpened) {
  const test::TemporaryFolder folder;
  const GdalMessages messages;
  const std::string grid = "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n";
  test::write_bytes(folder / "a.asc", grid);
  const auto vrt = [&](const char* name, const std::string& source) {
    test::write_bytes(folder / name,
                      "<VRTDataset rasterXSize=\"2\" rasterYSize=\"2\"><VRTRasterBand dataType=\"Float32\" band=\"1\">"
                      "<SimpleSource><SourceFilename relativeToVRT=\"1\">" +
                          source + "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>");
    return folder / name;
  };
  const auto opens = [](const std::filesystem::path& file) { return open_raster(file) != nullptr; };
  EXPECT_TRUE(opens(folder / "a.asc"));
  EXPECT_TRUE(opens(vrt("own.vrt", "a.asc")));
  EXPECT_FALSE(opens(vrt("far.vrt", "/vsicurl/http://127.0.0.1:9/a.tif")));
  EXPECT_FALSE(opens(vrt("near.vrt", "/vsimem/a.tif")));
  test::write_bytes(folder / "wms.xml",
                    "<GDAL_WMS><Service name=\"TMS\"><ServerUrl>http://127.0.0.1:9/${z}/${x}/${y}.png</ServerUrl></Service><DataWindow>"
                    "<UpperLeftX>0</UpperLeftX><UpperLeftY>1</UpperLeftY><LowerRightX>1</LowerRightX><LowerRightY>0</LowerRightY>"
                    "<TileLevel>1</TileLevel></DataWindow></GDAL_WMS>");
  EXPECT_FALSE(opens(folder / "wms.xml"));
  EXPECT_NE(messages.text().find("no local files"), std::string::npos) << messages.text();
  // Escapes, a service beside the file, and a site whose name begins like GDAL's file systems.
  EXPECT_FALSE(opens(vrt("escaped.vrt", "&#47;vsicurl&#47;http:&#47;&#47;127.0.0.1:9&#47;a.tif")));
  const std::filesystem::path service = vrt("service.vrt", "wms.xml");
  if (const Dataset d = open_raster(service)) {
    float v = 0.0F;
    EXPECT_NE(d->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 1, 1, &v, 1, 1, GDT_Float32, 0, 0), CE_None);
  }
  EXPECT_EQ(GetGDALDriverManager()->GetDriverByName("WMS"), nullptr);
  std::filesystem::create_directory(folder / "vsite");
  test::write_bytes(folder / "vsite/a.asc", grid);
  EXPECT_TRUE(opens(vrt("site.vrt", "vsite/a.asc")));
  EXPECT_FALSE(opens(folder.path()));
  EXPECT_EQ(open_vector(folder / "a.asc"), nullptr);
}

// 25 000 bands interleaved by pixel: a file of 2 kB of which GDAL would hold blocks of 26 GB.
TEST(GdalDoor, ARasterOfHugeBlocksIsNotOpened) {
  const test::TemporaryFolder folder;
  const GdalMessages messages;
  const auto make = [&](const char* name, int bands) {
    const char* const options[] = {"TILED=YES", "BLOCKXSIZE=512", "BLOCKYSIZE=512", "INTERLEAVE=PIXEL", "SPARSE_OK=YES", nullptr};
    const std::filesystem::path file = folder / name;
    GDALClose(
        GetGDALDriverManager()->GetDriverByName("GTiff")->Create(file.c_str(), 6, 5, bands, GDT_Float32, const_cast<char**>(options)));
    return file;
  };
  EXPECT_NE(open_raster(make("few.tif", 4)), nullptr);
  EXPECT_EQ(open_raster(make("many.tif", 2000)), nullptr);
  EXPECT_NE(messages.text().find("one block of the raster takes 2000 MB"), std::string::npos) << messages.text();
  EXPECT_EQ(open_raster(make("256.tif", 256)), nullptr);  // 256 MB is what fuzzing refuses
}

// On some of these GDAL 3.6 reads for ever.
TEST(GdalDoor, ADxfWithBytesOfZeroIsNotOpened) {
  const test::TemporaryFolder folder;
  const GdalMessages messages;
  std::string text = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\ne\n10\n500000\n20\n5400000\n11\n500010\n21\n5400000\n0\nENDSEC\n0\nEOF\n";
  test::write_bytes(folder / "a.dxf", text);
  test::write_bytes(folder / "a", text);
  EXPECT_NE(open_vector(folder / "a.dxf"), nullptr);
  EXPECT_NE(open_vector(folder / "a"), nullptr);
  text[text.find("500010")] = '\0';
  test::write_bytes(folder / "b.dxf", text);
  test::write_bytes(folder / "b", text);
  EXPECT_EQ(open_vector(folder / "b.dxf"), nullptr);
  EXPECT_EQ(open_vector(folder / "b"), nullptr);
  EXPECT_NE(messages.text().find("bytes of 0"), std::string::npos) << messages.text();
  const GdalMessages of_others;
  test::write_bytes(folder / "c", "999\nmade by hand\n" + text);  // a comment comes first
  EXPECT_EQ(open_vector(folder / "c"), nullptr);
  EXPECT_NE(of_others.text().find("bytes of 0"), std::string::npos) << of_others.text();
}

}  // namespace
}  // namespace swath::io
