// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/raster/geotiff.h"

#include <cpl_conv.h>
#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <cmath>

#include "core/error.h"
#include "core/geo/crs.h"
#include "io/survey/info.h"
#include "io/vector/gdal_door.h"
#include "tests/io/file_size_limit.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A tilted plane with a void block, a lake and a strip of long edges.
core::Grid made_grid(int nx, int ny, double cell = 0.5) {
  core::Grid g(core::Lattice{cell, 1000000, 9200000, nx, ny});
  g.sigma.assign(g.lattice.size(), 0.05f);
  g.count.assign(g.lattice.size(), 7);
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const size_t k = g.lattice.at(i, j);
      g.reason[k] = core::Void::none;
      g.height[k] = 100.0f + 0.25f * static_cast<float>(i) + 0.125f * static_cast<float>(j);
      if (i < 3 && j < 2) g.reason[k] = core::Void::no_data;
      if (i == 5) g.reason[k] = core::Void::water;
      if (j == 4) g.reason[k] = core::Void::long_edge;
      if (g.reason[k] != core::Void::none) {
        g.height[k] = g.sigma[k] = std::numeric_limits<float>::quiet_NaN();
        g.count[k] = 0;
      }
    }
  return g;
}

void expect_same(const std::vector<float>& a, const std::vector<float>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t k = 0; k < a.size(); ++k)
    if (!(std::isnan(a[k]) && std::isnan(b[k]))) {
      ASSERT_EQ(a[k], b[k]) << k;
    }
}

TEST(GeoTiff, HeightAndQualityReturnBitForBit) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(40, 30);
  write_grid(folder / "a_dtm.tif", g, "EPSG:32632");
  write_grid(folder / "a_dtm_quality.tif", g, "EPSG:32632", quality_bands);
  EXPECT_EQ(test::entries(folder.path()), 2u);
  const core::Grid h = read_grid(folder / "a_dtm.tif");
  EXPECT_EQ(h.lattice, g.lattice);
  expect_same(h.height, g.height);
  EXPECT_EQ(h.reason[0], core::Void::no_data);
  EXPECT_TRUE(h.sigma.empty() && h.count.empty());
  const core::Grid q = read_grid(folder / "a_dtm_quality.tif");
  expect_same(q.sigma, g.sigma);
  EXPECT_EQ(q.count, g.count);
  EXPECT_EQ(q.reason, g.reason);
  for (const float v : q.height) ASSERT_TRUE(std::isnan(v));
}

TEST(GeoTiff, IsACogThatStatesUnitsNodataAndOrientation) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(1300, 700);
  const auto file = folder / "a.tif";
  write_grid(file, g, "EPSG:25832+7837");
  const GdalMessages registered;
  auto* d = GDALDataset::Open(file.c_str());
  ASSERT_NE(d, nullptr);
  EXPECT_STREQ(d->GetMetadataItem("LAYOUT", "IMAGE_STRUCTURE"), "COG");
  EXPECT_STREQ(d->GetMetadataItem("COMPRESSION", "IMAGE_STRUCTURE"), "DEFLATE");
  EXPECT_STREQ(d->GetMetadataItem("PREDICTOR", "IMAGE_STRUCTURE"), "3");
  EXPECT_STREQ(d->GetMetadataItem(GDALMD_AREA_OR_POINT), GDALMD_AOP_AREA);
  GDALRasterBand* band = d->GetRasterBand(1);
  EXPECT_EQ(band->GetRasterDataType(), GDT_Float32);
  EXPECT_STREQ(band->GetDescription(), "height");
  EXPECT_STREQ(band->GetUnitType(), "m");
  EXPECT_EQ(band->GetNoDataValue(), raster_nodata);
  EXPECT_EQ(band->GetOverviewCount(), 2);
  const OGRSpatialReference* srs = d->GetSpatialRef();
  ASSERT_NE(srs, nullptr);
  EXPECT_TRUE(srs->IsCompound());
  EXPECT_STREQ(srs->GetAuthorityCode("PROJCS"), "25832");
  EXPECT_STREQ(srs->GetAuthorityCode("VERT_CS"), "7837");
  // The first row of the file is the northern one.
  float north_west = 0, south_east = 0;
  ASSERT_EQ(band->RasterIO(GF_Read, 0, 0, 1, 1, &north_west, 1, 1, GDT_Float32, 0, 0, nullptr), CE_None);
  ASSERT_EQ(band->RasterIO(GF_Read, 1299, 699, 1, 1, &south_east, 1, 1, GDT_Float32, 0, 0, nullptr), CE_None);
  EXPECT_EQ(north_west, g.height[g.lattice.at(0, 699)]);
  EXPECT_EQ(south_east, g.height[g.lattice.at(1299, 0)]);
  double t[6];
  d->GetGeoTransform(t);
  EXPECT_EQ(t[0], g.lattice.west());
  EXPECT_EQ(t[3], g.lattice.north());
  // Overviews average heights and leave voids out of the mean (a nodata of -9999 in a mean would show).
  GDALRasterBand* small = band->GetOverview(1);
  std::vector<float> v(static_cast<size_t>(small->GetXSize()) * static_cast<size_t>(small->GetYSize()));
  ASSERT_EQ(small->RasterIO(GF_Read, 0, 0, small->GetXSize(), small->GetYSize(), v.data(), small->GetXSize(), small->GetYSize(),
                            GDT_Float32, 0, 0, nullptr),
            CE_None);
  for (const float h : v)
    if (h != static_cast<float>(raster_nodata)) {
      ASSERT_GE(h, 100.0f);
    }
  GDALClose(d);
}

TEST(GeoTiff, FeetStayFeetInBothParts) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(20, 20, 2.0);
  write_grid(folder / "a.tif", g, "EPSG:2263+6360");
  const RasterInfo info = read_raster_info(folder / "a.tif");
  EXPECT_EQ(info.units.at(0), "ftUS");
  EXPECT_EQ(info.types.at(0), "Float32");
  EXPECT_NE(info.crs_wkt.find("COMPOUNDCRS"), std::string::npos);
  EXPECT_NE(info.crs_wkt.find("US survey foot"), std::string::npos);
  write_grid(folder / "b.tif", g, "EPSG:2263+5703");  // horizontal feet, heights in metres
  EXPECT_EQ(read_raster_info(folder / "b.tif").units.at(0), "m");
  write_grid(folder / "c.tif", g, "");
  EXPECT_TRUE(read_raster_info(folder / "c.tif").crs_wkt.empty());
}

TEST(GeoTiff, BytesDoNotDependOnThreadsOrRun) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(1300, 700);
  write_grid(folder / "a.tif", g, "EPSG:32632");
  CPLSetConfigOption("GDAL_NUM_THREADS", "ALL_CPUS");
  write_grid(folder / "b.tif", g, "EPSG:32632");
  CPLSetConfigOption("GDAL_NUM_THREADS", nullptr);
  EXPECT_EQ(test::read_bytes(folder / "a.tif"), test::read_bytes(folder / "b.tif"));
}

TEST(GeoTiff, AWindowIsCutAndFilledWithNoData) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(40, 30);
  write_grid(folder / "a.tif", g, "EPSG:32632");
  core::Lattice w = g.lattice;
  w.i0 += 30, w.j0 -= 2, w.nx = 20, w.ny = 10;
  const core::Grid part = read_grid(folder / "a.tif", w);
  EXPECT_EQ(part.lattice, w);
  for (int j = 0; j < w.ny; ++j)
    for (int i = 0; i < w.nx; ++i) {
      const bool inside = j >= 2 && i < 10;
      const float want = inside ? g.height[g.lattice.at(i + 30, j - 2)] : std::numeric_limits<float>::quiet_NaN();
      if (std::isnan(want))
        EXPECT_TRUE(std::isnan(part.height[w.at(i, j)]) && part.reason[w.at(i, j)] == core::Void::no_data);
      else
        EXPECT_EQ(part.height[w.at(i, j)], want);
    }
  w.i0 += 1000;  // wholly outside
  for (const float v : read_grid(folder / "a.tif", w).height) ASSERT_TRUE(std::isnan(v));
  w.cell = 1.0;
  EXPECT_THROW(read_grid(folder / "a.tif", w), core::Error);
}

TEST(GeoTiff, AsciiGridsAreRead) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.asc",
                    "ncols 3\nnrows 2\nxllcorner 500000\nyllcorner 4600000\ncellsize 2\nNODATA_value -9999\n1.5 2 3\n4 -9999 6\n");
  const core::Grid g = read_grid(folder / "a.asc");
  EXPECT_EQ(g.lattice, (core::Lattice{2.0, 250000, 2300000, 3, 2}));
  EXPECT_EQ(g.height[g.lattice.at(0, 1)], 1.5f);  // the first line is the northern row
  EXPECT_EQ(g.height[g.lattice.at(2, 0)], 6.0f);
  EXPECT_TRUE(std::isnan(g.height[g.lattice.at(1, 0)]));
  EXPECT_EQ(g.reason[g.lattice.at(1, 0)], core::Void::no_data);
  const Raster r = read_raster(folder / "a.asc");
  EXPECT_EQ(r.nx, 3);
  EXPECT_EQ(r.values.at(0), 1.5);
  EXPECT_TRUE(std::isnan(r.values.at(4)));
  EXPECT_EQ(r.geotransform[3], 4600004.0);
  EXPECT_THROW(read_raster(folder / "a.asc", 2), core::Error);
}

TEST(GeoTiff, TrueTerrainOfTheSharedSurveyIsRead) {
  SWATH_SHARED_OR_SKIP(dtm, "data/tiny_survey/truth/dtm_1m.tif");
  const Raster r = read_raster(dtm);
  const core::Grid g = read_grid(dtm);
  ASSERT_EQ(r.nx, g.lattice.nx);
  for (int j = 0; j < r.ny; ++j)
    for (int i = 0; i < r.nx; ++i) {
      const double a = r.values[static_cast<size_t>(j) * static_cast<size_t>(r.nx) + static_cast<size_t>(i)];
      if (!std::isnan(a)) {
        ASSERT_EQ(static_cast<float>(a), g.height[g.lattice.at(i, r.ny - 1 - j)]);
      }
    }
  EXPECT_FALSE(r.crs_wkt.empty());
}

void write_plain(const std::filesystem::path& file, std::array<double, 6> geotransform, GDALDataType type = GDT_Float32, double value = 1,
                 std::optional<double> nodata = {}) {
  const GdalMessages registered;
  auto* d = GetGDALDriverManager()->GetDriverByName("GTiff")->Create(file.c_str(), 4, 3, 1, type, nullptr);
  d->SetGeoTransform(geotransform.data());
  if (nodata) d->GetRasterBand(1)->SetNoDataValue(*nodata);
  d->GetRasterBand(1)->Fill(value);
  GDALClose(d);
}

TEST(GeoTiff, RastersThatAreNoLatticeAreRefusedWithAHint) {
  const test::TemporaryFolder folder;
  write_plain(folder / "rotated.tif", {0, 1, 0.1, 3, 0.1, -1});
  write_plain(folder / "oblong.tif", {0, 1, 0, 6, 0, -2});
  write_plain(folder / "south.tif", {0, 1, 0, 0, 0, 1});
  write_plain(folder / "off.tif", {0.25, 1, 0, 3, 0, -1});
  for (const char* name : {"rotated.tif", "oblong.tif", "south.tif", "off.tif"}) try {
      read_grid(folder / name);
      FAIL() << name;
    } catch (const core::Error& e) {
      EXPECT_FALSE(e.hint().empty()) << name;
      EXPECT_NE(e.where().find(name), std::string::npos);
    }
  EXPECT_EQ(read_raster(folder / "off.tif").geotransform[0], 0.25);  // still readable as it is
  EXPECT_EQ(read_raster(folder / "rotated.tif").geotransform[2], 0.1);
}

TEST(GeoTiff, NodataOfEveryTypeBecomesNaN) {
  const test::TemporaryFolder folder;
  const std::array<double, 6> north_up{0, 1, 0, 3, 0, -1};
  write_plain(folder / "a.tif", north_up, GDT_Float32, -3.4028234663852886e38, -3.4028234663852886e38);
  write_plain(folder / "b.tif", north_up, GDT_Float64, -1.7976931348623157e308, -1.7976931348623157e308);
  write_plain(folder / "c.tif", north_up, GDT_Int16, -32768, -32768);
  for (const char* name : {"a.tif", "b.tif", "c.tif"})
    for (const float v : read_grid(folder / name).height) ASSERT_TRUE(std::isnan(v)) << name;
  write_plain(folder / "d.tif", north_up, GDT_Int16, 12, -32768);
  for (const float v : read_grid(folder / "d.tif").height) ASSERT_EQ(v, 12.0f);
}

TEST(GeoTiff, BadInputsAndOutputsAreErrors) {
  const test::TemporaryFolder folder;
  EXPECT_THROW(read_grid(folder / "none.tif"), core::Error);
  test::write_bytes(folder / "text.tif", "not a raster");
  EXPECT_THROW(read_raster(folder / "text.tif"), core::Error);
  core::Grid g = made_grid(10, 10);
  EXPECT_THROW(write_grid(folder / "text.tif/a.tif", g, ""), core::Error);
  EXPECT_THROW(write_grid(folder / "a.tif", g, "no such CRS"), core::Error);
  g.sigma.clear();
  EXPECT_THROW(write_grid(folder / "a.tif", g, "", quality_bands), core::Error);
  EXPECT_THROW(write_grid(folder / "a.tif", core::Grid(), ""), core::Error);
  EXPECT_EQ(test::entries(folder.path()), 1u);
}

TEST(GeoTiff, ATruncatedFileIsAnErrorThatNamesTheRow) {
  const test::TemporaryFolder folder;
  core::Grid g = made_grid(900, 900);
  for (size_t k = 0; k < g.height.size(); ++k) g.height[k] = static_cast<float>(std::sin(static_cast<double>(k) * 12.9898) * 43758.5);
  write_grid(folder / "a.tif", g, "EPSG:32632");
  const std::string whole = test::read_bytes(folder / "a.tif");
  test::write_bytes(folder / "b.tif", whole.substr(0, whole.size() / 2));
  EXPECT_THROW(read_grid(folder / "b.tif"), core::Error);
}

TEST(GeoTiff, AWriteThatIsCutShortAnywhereLeavesNothing) {
  const test::TemporaryFolder folder;
  const core::Grid g = made_grid(300, 200);
  write_grid(folder / "a.tif", g, "EPSG:32632");
  const auto whole = std::filesystem::file_size(folder / "a.tif");
  std::filesystem::remove(folder / "a.tif");
  constexpr unsigned steps = 12;
  for (unsigned s = 0; s < steps; ++s) {
    const test::FileSizeLimit limit(s + 1 == steps ? whole - 1 : whole * s / steps);
    EXPECT_THROW(write_grid(folder / "a.tif", g, "EPSG:32632"), core::SystemError) << s;  // the run's work stays
    EXPECT_EQ(test::entries(folder.path()), 0u) << s;
  }
}

TEST(GeoTiff, AProjectionWithEllipsoidalHeightsKeepsItsCrs) {
  const test::TemporaryFolder folder;
  const core::Grid grid = made_grid(8, 8);
  write_grid(folder / "a.tif", grid, "EPSG:32632+ellipsoidal", height_bands);
  const core::Crs crs(read_raster_info(folder / "a.tif").crs_wkt);
  EXPECT_EQ(crs.epsg(), 32632);
  EXPECT_EQ(describe_file(folder / "a.tif").find("heights")->as_text(), "ellipsoidal height");
}

TEST(GeoTiff, ALatticeOfDamagedNumbersIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  RasterInfo info;
  info.nx = info.ny = 3;
  for (const double wrong : {nan, std::numeric_limits<double>::infinity(), 1e300})
    for (const size_t k : {0u, 1u, 3u, 5u}) {
      info.geotransform = {0, 1, 0, 3, 0, -1};
      info.geotransform[k] = wrong;
      EXPECT_THROW(lattice_of(info, "a.tif"), core::Error) << wrong << " at " << k;
    }
  info.geotransform = {0, 1e-300, 0, 3, 0, -1e-300};
  EXPECT_THROW(lattice_of(info, "a.tif"), core::Error);
}

// From the south, GDAL took 2^58 readings to say so. The window lies behind the cut, too.
TEST(GeoTiff, AnAsciiGridThatIsCutShortIsRefusedAtOnce) {
  const test::TemporaryFolder folder;
  std::string text = "ncols 3\nnrows 60\nxllcorner 500000\nyllcorner 5400000\ncellsize 1\nNODATA_value -9999\n";
  for (int row = 0; row < 60; ++row) text += "1 2 " + std::to_string(row) + "\n";
  test::write_bytes(folder / "whole.asc", text);
  test::write_bytes(folder / "cut.asc", text.substr(0, text.find("1 2 2\n")));
  const core::Lattice south{1, 500000, 5400000, 3, 5};
  EXPECT_EQ(read_grid(folder / "whole.asc").height.front(), 1);
  EXPECT_EQ(read_grid(folder / "whole.asc", south).height[south.at(2, 4)], 55);
  EXPECT_THROW(read_grid(folder / "cut.asc"), core::Error);
  EXPECT_THROW(read_grid(folder / "cut.asc", south), core::Error);
  EXPECT_THROW(read_raster(folder / "cut.asc"), core::Error);
  EXPECT_TRUE(std::isnan(read_grid(folder / "cut.asc", core::Lattice{1, 500000, 5399990, 3, 5}).height.front()));  // outside
  test::write_bytes(folder / "cut.vrt",
                    R"(<VRTDataset rasterXSize="3" rasterYSize="60"><GeoTransform>500000, 1, 0, 5400060, 0, -1</GeoTransform>)"
                    R"(<VRTRasterBand dataType="Float32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">cut.asc</SourceFilename>)"
                    R"(<SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>)");
  EXPECT_THROW(read_grid(folder / "cut.vrt", south), core::Error);
}

TEST(Geotiff, ColoursOf8And16BitsAndWhereThereAreNone) {
  const test::TemporaryFolder folder;
  const core::Lattice lattice{0.25, 8, 12, 3, 2};
  const std::vector<std::uint16_t> red{256, 512, 65535, 1, 0, 400}, green(6, 5120), blue(6, 0);
  const std::vector<std::uint8_t> is_there{1, 1, 1, 0, 1, 1};
  for (const int bits : {8, 16}) {
    write_colours(folder.path() / "a.tif", lattice, {&red, &green, &blue, &is_there}, bits, "EPSG:25832");
    const RasterInfo info = read_raster_info(folder.path() / "a.tif");
    EXPECT_EQ(info.names, (std::vector<std::string>{"red", "green", "blue", "alpha"}));
    EXPECT_EQ(info.types, std::vector<std::string>(4, bits == 8 ? "Byte" : "UInt16"));
    EXPECT_EQ(lattice_of(info, "a.tif"), lattice);
    const GdalMessages messages;
    const Dataset d = open_raster(folder.path() / "a.tif");
    ASSERT_TRUE(d);
    EXPECT_EQ(d->GetRasterBand(4)->GetColorInterpretation(), GCI_AlphaBand);
    const auto values_of = [&](int band) {
      std::vector<std::uint16_t> out(6);  // from the north
      EXPECT_EQ(d->GetRasterBand(band)->RasterIO(GF_Read, 0, 0, 3, 2, out.data(), 3, 2, GDT_UInt16, 0, 0, nullptr), CE_None);
      return out;
    };
    using Values = std::vector<std::uint16_t>;
    EXPECT_EQ(values_of(1), bits == 8 ? (Values{0, 0, 2, 1, 2, 255}) : (Values{1, 0, 400, 256, 512, 65535}));
    EXPECT_EQ(values_of(4), bits == 8 ? (Values{0, 255, 255, 255, 255, 255}) : (Values{0, 65535, 65535, 65535, 65535, 65535}));
  }
}

}  // namespace
}  // namespace swath::io
