// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/vector/point_layer.h"

#include <gdal_priv.h>
#include <gtest/gtest.h>
#include <ogrsf_frmts.h>

#include <cmath>

#include "core/error.h"
#include "io/text/value_file.h"
#include "io/vector/gdal_door.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

TEST(PointLayer, PointsWithTheirNumbers) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "points.gpkg";
  const std::vector<NamedPoint> points{{"a", "tie", {500000.25, 5300000.5, 412.125}, {3.0, 0.02}},
                                       {"b", "control", {500001, 5300001, 1}, {2.0, std::nan("")}}};
  write_point_layer(file, "points", "EPSG:25832", {"rays", "sigma"}, points);
  const GdalMessages messages;
  const Dataset set = open_vector(file);
  ASSERT_TRUE(set);
  OGRLayer* layer = set->GetLayerByName("points");
  ASSERT_TRUE(layer);
  ASSERT_EQ(layer->GetFeatureCount(), 2);
  EXPECT_STREQ(layer->GetSpatialRef()->GetAuthorityCode(nullptr), "25832");
  const OGRFeatureUniquePtr a(layer->GetNextFeature()), b(layer->GetNextFeature());
  EXPECT_STREQ(a->GetFieldAsString("name"), "a");
  EXPECT_EQ(a->GetFieldAsDouble("rays"), 3.0);
  EXPECT_EQ(a->GetGeometryRef()->toPoint()->getZ(), 412.125);
  EXPECT_FALSE(b->IsFieldSetAndNotNull(b->GetFieldIndex("sigma")));
  const std::string first = read_text_file(file);
  write_point_layer(file, "points", "EPSG:25832", {"rays", "sigma"}, points);
  EXPECT_EQ(read_text_file(file), first);
  for (const char* crs : {"EPSG:25832+ellipsoidal", "EPSG:25832+7837", "EPSG:4979"})
    EXPECT_NO_THROW(write_point_layer(file, "points", crs, {"rays", "sigma"}, points)) << crs;
  EXPECT_THROW(write_point_layer(file, "points", "", {"rays"}, points), core::Error);
}

}  // namespace
}  // namespace swath::io
