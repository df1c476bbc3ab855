// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/side_files.h"

#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include "io/raster/geotiff.h"
#include "io/raster/vrt.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

std::vector<std::string> names(const std::filesystem::path& file) {
  std::vector<std::string> out;
  for (const auto& f : side_files(file)) out.push_back(f.filename().string());
  return out;
}

TEST(SideFiles, OfAShapefile) {
  const test::TemporaryFolder folder;
  {
    const GdalMessages messages;
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("ESRI Shapefile");
    const Dataset set(driver->Create((folder / "lines.shp").c_str(), 0, 0, 0, GDT_Unknown, nullptr));
    OGRLayer* layer = set->CreateLayer("lines", nullptr, wkbLineString, nullptr);
    OGRFeature feature(layer->GetLayerDefn());
    OGRLineString line;
    line.addPoint(1, 2), line.addPoint(3, 4);
    feature.SetGeometry(&line);
    ASSERT_EQ(layer->CreateFeature(&feature), OGRERR_NONE);
  }
  EXPECT_EQ(names(folder / "lines.shp"), (std::vector<std::string>{"lines.dbf", "lines.shx"}));
  test::write_bytes(folder / "lines.prj", "LOCAL_CS[\"x\"]");
  EXPECT_EQ(names(folder / "lines.shp"), (std::vector<std::string>{"lines.dbf", "lines.prj", "lines.shx"}));
}

TEST(SideFiles, OfAVirtualRasterWithItsSourcesAndWhatLiesBesideThem) {
  const test::TemporaryFolder folder;
  const core::Lattice lattice{1.0, 0, 0, 4, 4};
  const std::vector<float> values(lattice.size(), 1.0f);
  write_raster(folder / "tiles/a.tif", lattice, {{"height", "m", &values}}, "EPSG:32632", false);
  write_vrt(folder / "all.vrt", {folder / "tiles/a.tif"});
  EXPECT_EQ(names(folder / "all.vrt"), std::vector<std::string>{"a.tif"});
  test::write_bytes(folder / "tiles/a.tif.aux.xml", "<PAMDataset></PAMDataset>");
  EXPECT_EQ(names(folder / "all.vrt"), (std::vector<std::string>{"a.tif", "a.tif.aux.xml"}));
}

TEST(SideFiles, OthersHaveNone) {
  const test::TemporaryFolder folder;
  test::write_bytes(folder / "a.npy", "x");
  test::write_bytes(folder / "broken.shp", "x");
  EXPECT_TRUE(side_files(folder / "a.npy").empty());
  EXPECT_TRUE(side_files(folder / "broken.shp").empty());
  EXPECT_TRUE(side_files(folder / "none.tif").empty());
}

}  // namespace
}  // namespace swath::io
