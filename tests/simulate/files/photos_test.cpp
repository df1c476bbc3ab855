// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/photos.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>

#include "io/raster/geotiff.h"
#include "io/raster/image_raster.h"
#include "io/text/text_table.h"
#include "simulate/simulate.h"
#include "simulate/world/colours.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

Options small_photos() {
  Options o;
  o.output.laser = false;
  o.imu.file = o.gnss.file = false;
  o.events.file = o.camera.file = o.camera.photos = true;
  o.events.interval = core::Seconds(0.6);
  o.world.scene = Scene::hills;
  o.world.trees = 0.0, o.world.buildings = 0.0, o.world.low_vegetation = 0.0, o.world.crops = 0.0;
  o.world.length = core::Metres(300.0), o.world.width = core::Metres(200.0);
  o.flight.lines = 1, o.flight.cross_lines = 0, o.flight.height = core::Metres(300.0);
  o.camera.columns = 360, o.camera.rows = 270;
  o.camera.f = core::Metres(0.02), o.camera.nominal_f = core::Metres(0.02), o.camera.pixel = core::Metres(3e-5);  // 0.45 m on the ground
  o.camera.k1 = -1e-4, o.camera.k2 = 0.0;
  o.camera.points = 60;
  o.noise.noise_free = true;
  return o;
}

TEST(Photos, APointsPixelHasTheColourOfItsPlace) {
  const test::TemporaryFolder folder;
  const Options o = small_photos();
  const Made made = run(o, folder.path(), {});
  ASSERT_TRUE(made.images);
  const io::TextTable marks(folder.path() / "image_points.csv"), ground(folder.path() / "truth" / "camera_points.csv");
  const io::RasterInfo truth = io::read_raster_info(folder.path() / "truth" / "orthophoto.tif");
  EXPECT_EQ(truth.names.size(), 4u);
  std::map<std::string, Eigen::Vector3d> places;
  for (size_t r = 0; r < ground.rows(); ++r) places[ground.text(r, 0)] = {ground.number(r, 1), ground.number(r, 2), ground.number(r, 3)};
  std::map<std::string, io::ImageRaster> photos;
  std::array<io::Raster, 3> bands;
  for (int b = 0; b < 3; ++b) bands[static_cast<size_t>(b)] = io::read_raster(folder.path() / "truth" / "orthophoto.tif", b + 1);
  // Both the photograph and the view from above are samples of one field: where it is smooth over a pixel they agree.
  double sum = 0.0, other = 0.0;
  int n = 0;
  for (size_t r = 0; r < marks.rows(); ++r) {
    const auto [at, is_new] = photos.try_emplace(marks.text(r, 0));
    if (is_new) at->second = io::read_image_raster(folder.path() / "photos" / (marks.text(r, 0) + ".tif"));
    const io::ImageRaster& photo = at->second;
    const auto pixel = photo.at(static_cast<int>(marks.number(r, 2)), static_cast<int>(marks.number(r, 3)));
    const Eigen::Vector3d p = places[marks.text(r, 1)];
    const int i = static_cast<int>((p.x() - truth.geotransform[0]) / truth.geotransform[1]),
              j = static_cast<int>((p.y() - truth.geotransform[3]) / truth.geotransform[5]);
    if (i < 0 || j < 0 || i >= truth.nx || j >= truth.ny) continue;
    const auto from_above = bands[0].values[static_cast<size_t>(j) * static_cast<size_t>(truth.nx) + static_cast<size_t>(i)];
    const auto aside = bands[0].values[static_cast<size_t>(j) * static_cast<size_t>(truth.nx) + static_cast<size_t>((i + 20) % truth.nx)];
    sum += std::abs(from_above - photo.values[pixel]), other += std::abs(aside - photo.values[pixel]), ++n;
  }
  ASSERT_GT(n, 50);
  EXPECT_LT(sum / n, 7.0);                // of a contrast of 112
  EXPECT_GT(other / n, 1.7 * (sum / n));  // nine metres aside
}

}  // namespace
}  // namespace swath::simulate
