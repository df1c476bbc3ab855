// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/orthophoto.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "calib/block/imagery/image_colours.h"
#include "core/geo/frames.h"
#include "tests/calib/block/imagery/made_photos.h"

namespace swath::calib::test {
namespace {

using Eigen::Vector3d;

const std::vector<MadePhoto> three{{"1", {20, 50, 100}, {0.02, 0.03, 0.2}, 0.1},
                                   {"2", {50, 50, 102}, {0.0, -0.02, 0.25}, 0.1},
                                   {"3", {80, 50, 99}, {-0.03, 0.01, 0.15}, 0.1}};

/// The scene's surface, or its ground alone.
core::Grid surface_of(const MadeScene& scene, bool with_house) {
  core::Grid g({1.0, 0, 0, 100, 100});
  g.sigma.assign(g.lattice.size(), 0.2f);
  for (int j = 0; j < 100; ++j)
    for (int i = 0; i < 100; ++i) g.height[g.lattice.at(i, j)] = with_house ? static_cast<float>(scene.height(i + 0.5, j + 0.5)) : 0.0f;
  g.height[g.lattice.at(30, 40)] = std::numeric_limits<float>::quiet_NaN();
  return g;
}

const core::Lattice own{0.5, 40, 60, 120, 80};  // 20..80 east, 30..70 north

double difference(const Orthophoto& photo, int i, int j, double blue) {
  const size_t at = photo.lattice.at(i, j);
  const auto truth = MadeScene::colour(photo.lattice.centre_x(i), photo.lattice.centre_y(j), blue);
  return std::max({std::abs(photo.red[at] / 256.0 - truth[0]), std::abs(photo.green[at] / 256.0 - truth[1]),
                   std::abs(photo.blue[at] / 256.0 - truth[2])});
}

TEST(Orthophoto, LevelGroundIsWhereItIs) {
  MadeScene scene;
  scene.roof = 0.0;
  const MadePhotos photos(three, scene);
  const Orthophoto photo = make_orthophoto(photos.read(), surface_of(scene, false), own, {});
  EXPECT_EQ(photo.counts.seen + photo.counts.without_surface, own.size());
  EXPECT_EQ(photo.counts.without_surface, 4u);
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i)
      if (photo.image[own.at(i, j)] != no_image) {
        EXPECT_LT(difference(photo, i, j, 40.0), 0.7);  // 8 bits, 0.1 m
      }
}

TEST(Orthophoto, OnTheSurfaceRoofsAreInTheirPlaceAndWhatTheyHideIsVoid) {
  MadeScene scene;
  scene.roof = 25.0;
  const MadePhotos photos({three[0], three[2]}, scene);
  const OrientedImages images = photos.read();
  const Orthophoto photo = make_orthophoto(images, surface_of(scene, true), own, {});
  size_t roof = 0, wrong = 0;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) {
      const double x = own.centre_x(i), y = own.centre_y(j);
      const double rim = std::min({std::abs(x - 40), std::abs(x - 60), std::abs(y - 40), std::abs(y - 60)});
      if (photo.image[own.at(i, j)] == no_image || rim < 2.0) continue;
      roof += scene.is_house(x, y);
      wrong += difference(photo, i, j, scene.is_house(x, y) ? 200.0 : 40.0) > 1.2;
    }
  EXPECT_GT(roof, 800u);
  EXPECT_LT(wrong, photo.counts.seen / 50);  // where rays pass the roof's edge, which the surface knows to a metre
  // On the ground's surface the roof leans, and covers ground with its colour.
  const Orthophoto leaning = make_orthophoto(images, surface_of(scene, false), own, {});
  EXPECT_EQ(leaning.counts.hidden, 0u);
  size_t covered = 0;
  for (int j = 0; j < own.ny; ++j)
    for (int i = 0; i < own.nx; ++i) covered += !scene.is_house(own.centre_x(i), own.centre_y(j)) && leaning.blue[own.at(i, j)] > 150 * 256;
  EXPECT_GT(covered, 50u);
}

TEST(Orthophoto, AHighTerraceHidesTheGroundBehindIt) {
  MadeScene scene;
  scene.roof = 25.0;
  const MadePhotos photos({three[0]}, scene);
  const Orthophoto photo = make_orthophoto(photos.read(), surface_of(scene, true), own, {});
  const auto image_at = [&](double x, double y) {
    return photo.image[own.at(static_cast<int>((x - 20) / 0.5), static_cast<int>((y - 30) / 0.5))];
  };
  EXPECT_EQ(image_at(62, 50), no_image);  // the camera stands in the west
  EXPECT_NE(image_at(37, 50), no_image);
  EXPECT_GT(photo.counts.hidden, 100u);
}

TEST(Orthophoto, TheVarianceIsThatOfPlacesByOrientationsAndCamerasWithErrors) {
  constexpr int all = 6 + camera_values;
  using Errors = Eigen::Matrix<double, all, 1>;
  OrientedImages images;
  images.cameras.emplace_back();
  images.cameras[0].value[0] = 50.0;
  images.images.emplace_back();
  OrientedImage& image = images.images[0];
  image.local = {10, -20, 900};
  image.camera_R_local = rotation_of({0.06, -0.1, 0.8}).transpose();
  Eigen::Matrix<double, all, all> root = Eigen::Matrix<double, all, all>::Zero();
  root.diagonal().head<6>() << 0.06, 0.05, 0.09, 3e-4, 3e-4, 1.5e-4;
  root(3, 1) = 3e-5, root(4, 0) = -4e-5, root(5, 2) = 2e-5, root(2, 0) = 0.03;
  root.diagonal().segment<4>(6) << 4e-3, 3e-3, 2e-3, 2e-6;       // f, x0, y0 in mm; k1
  root(6, 2) = 5e-3, root(7, 4) = 1.4e-2, root(8, 3) = -1.4e-2;  // as stations, tilts and the principal point have errors in common
  const Eigen::Matrix<double, all, all> C = root * root.transpose();
  image.covariance = C.topLeftCorner<6, 6>();
  image.with_camera = C.topRightCorner<6, camera_values>();
  images.camera_covariance = {C.bottomRightCorner<camera_values, camera_values>()};
  const Vector3d place(250, -380, 12);
  constexpr double sigma_height = 0.15;
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  double sum = 0.0;
  constexpr int n = 20000;
  const Vector3d way = image.camera_R_local * (place - image.local);
  const double x = -50.0 * way.x() / way.z(), y = -50.0 * way.y() / way.z(), r2 = x * x + y * y;  // measured
  for (int k = 0; k < n; ++k) {
    Errors e;
    for (int c = 0; c < all; ++c) e[c] = normal(random);
    e = root * e;
    const Vector3d at = image.local + e.head<3>();
    const Vector3d direction(x - e[7] - e[9] * x * r2, y - e[8] - e[9] * y * r2, -50.0 - e[6]);
    const Vector3d ray = image.camera_R_local.transpose() * core::exp_so3(-e.segment<3>(3)) * direction;  // (exp(w) camera_R_local)'
    const Vector3d met = at + (place.z() + sigma_height * normal(random) - at.z()) / ray.z() * ray;
    sum += (met - place).head<2>().squaredNorm();
  }
  const double stated = std::sqrt(variance_in_plan(images, 0, place, sigma_height));
  EXPECT_NEAR(stated / std::sqrt(sum / n), 1.0, 0.02);
  image.with_camera.setZero();
  EXPECT_GT(std::abs(std::sqrt(variance_in_plan(images, 0, place, sigma_height)) / stated - 1.0), 0.1);
}

TEST(Orthophoto, SigmasAreThereWhereTheTableHasThem) {
  MadeScene scene;
  const MadePhotos photos(three, scene);
  const Orthophoto photo = make_orthophoto(photos.read(), surface_of(scene, false), own, {});
  const size_t below = own.at(60, 40);  // 50.25, 50.25: under the second image
  EXPECT_NEAR(photo.sigma[below], std::sqrt(2.0) * 0.1, 0.005);
  EXPECT_LT(photo.off_nadir[below], 0.01f);
  swath::test::write_bytes(photos.folder() / "orientation.csv", "image,x,y,z,omega,phi,kappa\n1,50,50,100,0,0,0\n");
  EXPECT_TRUE(std::isnan(make_orthophoto(photos.read(), surface_of(scene, false), own, {}).sigma[below]));
}

TEST(Orthophoto, WithoutASurfaceOrAnImageThereIsNothing) {
  const MadePhotos photos(three);
  const OrientedImages images = photos.read();
  const Orthophoto empty = make_orthophoto(images, core::Grid({1.0, 0, 0, 100, 100}), own, {});
  EXPECT_EQ(empty.counts.without_surface, own.size());
  EXPECT_EQ(empty.red, std::vector<std::uint16_t>(own.size(), 0));
  core::Grid far({1.0, 5000, 0, 10, 10});
  std::fill(far.height.begin(), far.height.end(), 0.0f);
  EXPECT_EQ(make_orthophoto(images, far, {1.0, 5000, 0, 10, 10}, {}).counts.outside, 100u);
}

}  // namespace
}  // namespace swath::calib::test
