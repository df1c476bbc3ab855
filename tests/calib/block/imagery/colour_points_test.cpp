// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/colour_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calib/block/imagery/made_photos.h"

namespace swath::calib::test {
namespace {

const std::vector<MadePhoto> three{
    {"1", {20, 50, 100}, {0.02, 0.03, 0.2}}, {"2", {50, 50, 102}, {0.0, -0.02, 0.25}}, {"3", {80, 50, 99}, {-0.03, 0.01, 0.15}}};

/// Points of the scene, those of the house's roof and of the ground around it.
core::Block points_of(const MadeScene& scene) {
  core::Block b;
  b.origin = {30, 30, -2};
  for (double x = 20; x < 80; x += 0.43)
    for (double y = 30; y < 70; y += 0.47) b.x.push_back(x - 30), b.y.push_back(y - 30), b.z.push_back(scene.height(x, y) + 2);
  b.classification.assign(b.size(), 1), b.flags.assign(b.size(), 0);
  return b;
}

double worst_difference(const core::Block& b, size_t i, const MadeScene& scene) {
  const double x = b.x[i] + 30, y = b.y[i] + 30;
  const auto truth = MadeScene::colour(x, y, scene.is_house(x, y) ? 200.0 : 40.0);
  return std::max({std::abs(b.red[i] / 256.0 - truth[0]), std::abs(b.green[i] / 256.0 - truth[1]), std::abs(b.blue[i] / 256.0 - truth[2])});
}

/// Of the points with a colour that lie off the house's outline.
double wrong_share(const core::Block& b, const MadeScene& scene) {
  size_t wrong = 0, far = 0;
  for (size_t i = 0; i < b.size(); ++i) {
    if (b.red[i] == 0) continue;
    const double rim = std::min({std::abs(b.x[i] - 10), std::abs(b.x[i] - 30), std::abs(b.y[i] - 10), std::abs(b.y[i] - 30)});
    if (rim < 1.2) continue;
    ++far;
    wrong += worst_difference(b, i, scene) > 1.1;  // rounding to 8 bits, and half a pixel at 2 per metre
  }
  EXPECT_GT(far, b.size() / 2);
  return static_cast<double>(wrong) / static_cast<double>(far);
}

TEST(ColourPoints, EachPointHasTheColourOfItsPlace) {
  MadeScene scene;
  scene.roof = 30.0;
  const MadePhotos photos(three, scene);
  core::Block b = points_of(scene);
  const ColourCounts n = colour_points(b, b.size(), photos.read(), {});
  EXPECT_EQ(n.coloured + n.hidden + n.outside, b.size());
  EXPECT_EQ(n.outside, 0u);
  EXPECT_LT(n.hidden, b.size() / 10);  // behind the house for all three
  // Where rays pass a roof's edge, which points and pixels know to half a metre, some take the wrong side's colour.
  EXPECT_LT(wrong_share(b, scene), 0.03);
  core::Block without = points_of(scene);
  ColourOptions as_if;
  as_if.hidden = HiddenColour::nearest, as_if.clearance = core::Metres(100.0);
  colour_points(without, without.size(), photos.read(), as_if);
  EXPECT_GT(wrong_share(without, scene), 3.0 * wrong_share(b, scene));
}

TEST(ColourPoints, TheBlackRimOfUndistortedPhotographsIsNoColour) {
  MadeScene scene;
  scene.roof = 0.0;
  const MadePhotos photos(three, scene);
  for (const MadePhoto& p : three) {
    const std::filesystem::path file = photos.folder() / "photos" / (p.name + ".tif");
    io::ImageRaster image = io::read_image_raster(file);
    for (int r = 0; r < image.rows; ++r)
      for (int c = 0; c < image.columns; ++c)
        if (c < 105) std::fill_n(&image.values[image.at(c, r)], 3, std::uint16_t{0});
    io::write_image_raster(file, image);
  }
  const auto wrong = [&](const OrientedImages& images) {
    core::Block b = points_of(scene);
    const ColourCounts n = colour_points(b, b.size(), images, {});
    EXPECT_EQ(n.coloured, b.size());  // another photograph shows what the rim of one does not
    size_t out = 0;
    for (size_t i = 0; i < b.size(); ++i) out += worst_difference(b, i, scene) > 1.1;
    return out;
  };
  OrientedImages images = photos.read();
  EXPECT_EQ(wrong(images), 0u);
  images.rims.clear();
  EXPECT_GT(wrong(images), 100u);
}

TEST(ColourPoints, WithoutTheSearchForWhatHidesGroundTakesTheRoofsColour) {
  MadeScene scene;
  scene.roof = 30.0;
  const MadePhotos photos({{"1", {50, 50, 100}}}, scene);  // sees the roof lean over the ground around it
  core::Block b = points_of(scene), all = b;
  const OrientedImages images = photos.read();
  const ColourCounts n = colour_points(b, b.size(), images, {});
  EXPECT_GT(n.hidden, 100u);
  ColourOptions as_if;
  as_if.hidden = HiddenColour::nearest;
  const ColourCounts m = colour_points(all, all.size(), images, as_if);
  EXPECT_EQ(m.hidden, 0u);
  EXPECT_EQ(m.coloured, n.coloured + n.hidden);
  size_t leaned = 0, of_hidden = 0;
  for (size_t i = 0; i < b.size(); ++i)
    if (b.red[i] == 0) ++of_hidden, leaned += all.blue[i] > 100 * 256;
  EXPECT_GT(leaned, of_hidden / 2);
}

TEST(ColourPoints, HaloHidesAndKeepsItsColours) {
  MadeScene scene;
  scene.roof = 30.0;
  const MadePhotos photos({{"1", {50, 50, 100}}}, scene);
  const OrientedImages images = photos.read();
  core::Block whole = points_of(scene);
  colour_points(whole, whole.size(), images, {});
  // The west alone as own points, the rest as halo.
  core::Block b = points_of(scene);
  std::vector<std::uint32_t> own, rest;
  for (std::uint32_t i = 0; i < b.size(); ++i) (b.x[i] < 9 ? own : rest).push_back(i);
  const size_t n = own.size();
  own.insert(own.end(), rest.begin(), rest.end());
  b = core::select(b, own);
  colour_points(b, n, images, {});
  for (size_t k = 0; k < b.size(); ++k) EXPECT_EQ(b.red[k], k < n ? whole.red[own[k]] : 0);
}

TEST(ColourPoints, AColourStaysWhereNoImageSeesThePoint) {
  const MadePhotos photos({{"1", {50, 50, 100}}});
  core::Block b;
  b.x = {50, 500}, b.y = {30, 500}, b.z = {0, 0};
  b.classification = {1, 1}, b.flags = {0, 0};
  b.red = b.green = b.blue = {7, 7};
  const ColourCounts n = colour_points(b, 2, photos.read(), {});
  EXPECT_EQ(n.outside, 1u);
  EXPECT_EQ(b.red[1], 7);
  EXPECT_NEAR(b.red[0] / 256.0, 120.0, 1.1);
  core::Block far;
  far.x = {5000}, far.y = {0}, far.z = {0}, far.classification = {1}, far.flags = {0};
  EXPECT_EQ(colour_points(far, 1, photos.read(), {}).outside, 1u);
  core::Block none;
  EXPECT_EQ(colour_points(none, 0, photos.read(), {}).coloured, 0u);
}

}  // namespace
}  // namespace swath::calib::test
