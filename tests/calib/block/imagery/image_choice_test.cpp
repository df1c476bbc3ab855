// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/image_choice.h"

#include <gtest/gtest.h>

#include "tests/calib/block/imagery/made_photos.h"

namespace swath::calib::test {
namespace {

using Eigen::Vector3d;

const core::Box box{0, 0, 100, 100};
constexpr auto nothing_hides = [](const Vector3d&) { return false; };

TEST(ImageChoice, TheImageOfTheSteepestRayThatNothingHides) {
  const MadePhotos photos({{"west", {30, 50, 100}}, {"east", {70, 50, 100}}});
  const OrientedImages images = photos.read();
  ImageChoice choice(images, box, 0.0, {});
  ImageView view;
  EXPECT_EQ(choice.best({40, 50, 0}, {40, 50, 0}, nothing_hides, view), Seen::seen);
  EXPECT_EQ(images.images[view.image].name, "west");
  EXPECT_NEAR(view.slope, 0.1, 1e-12);
  EXPECT_EQ(choice.best({60, 50, 0}, {60, 50, 0}, nothing_hides, view), Seen::seen);
  EXPECT_EQ(images.images[view.image].name, "east");
  EXPECT_EQ(choice.best({50, 50, 0}, {50, 50, 0}, nothing_hides, view), Seen::seen);
  EXPECT_EQ(images.images[view.image].name, "west");  // the first of two at one angle
  const auto west_hides = [](const Vector3d& camera) { return camera.x() < 50; };
  EXPECT_EQ(choice.best({40, 50, 0}, {40, 50, 0}, west_hides, view), Seen::seen);
  EXPECT_EQ(images.images[view.image].name, "east");
  EXPECT_EQ(choice.best(
                {40, 50, 0}, {40, 50, 0}, [](const Vector3d&) { return true; }, view),
            Seen::hidden);
  EXPECT_EQ(images.images[view.image].name, "west");  // the best, were it not hidden
}

TEST(ImageChoice, WhereAPixelIs) {
  const MadePhotos photos({{"one", {50, 50, 100}, {0.05, -0.08, 0.7}}});
  const OrientedImages images = photos.read();
  const ImageChoice choice(images, box, 0.0, {});
  const CameraConfig c = made_camera();
  const Vector3d local(58, 41, 3);
  const Vector3d d = rotation_of({0.05, -0.08, 0.7}).transpose() * (local - Vector3d(50, 50, 100));
  const double x = -20.0 * d.x() / d.z(), y = -20.0 * d.y() / d.z(), r2 = x * x + y * y;  // mm
  const double u = 0.15 + x + x * c.k1 * r2 + c.p1 * (r2 + 2 * x * x), v = -0.2 + y + y * c.k1 * r2 + 2 * c.p1 * x * y;
  const auto pixel = choice.pixel_of(0, local);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 120 + u / 0.1, 1e-9);
  EXPECT_NEAR(pixel->y(), 80 - v / 0.1, 1e-9);
  EXPECT_FALSE(choice.pixel_of(0, {50, 180, 0}));
  EXPECT_FALSE(choice.pixel_of(0, {50, 50, 120}));  // behind
}

TEST(ImageChoice, ObliqueRaysAndOtherPlacesAreLeftOut) {
  const MadePhotos photos({{"one", {50, 50, 100}}});
  const OrientedImages images = photos.read();
  SightOptions steep;
  steep.off_nadir = core::degrees(10.0);
  ImageView view;
  ImageChoice choice(images, box, 0.0, steep);
  EXPECT_EQ(choice.best({60, 50, 0}, {60, 50, 0}, nothing_hides, view), Seen::seen);
  EXPECT_EQ(choice.best({75, 50, 0}, {75, 50, 0}, nothing_hides, view), Seen::outside);
  EXPECT_TRUE(ImageChoice(images, {1000, 0, 1100, 100}, 0.0, {}).empty());
  EXPECT_TRUE(ImageChoice(images, box, 200.0, {}).empty());
  EXPECT_FALSE(ImageChoice(images, {100, 0, 110, 100}, 0.0, {}).empty());  // its corner reaches there
}

}  // namespace
}  // namespace swath::calib::test
