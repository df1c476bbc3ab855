// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/local_patch.h"

#include <gtest/gtest.h>

#include <random>

namespace swath::calib {
namespace {

TEST(LocalPatch, IsProjsToATwentiethOfAMillimetre) {
  OrientedImages images;
  images.map = {"EPSG:25832", 1.0, 1.0};
  images.middle = {688000, 5340000, 800};
  const core::Box box{687600.5, 5339800.0, 688111.0, 5340290.0};
  const LocalPatch patch(images, box), smaller(images, {687700, 5339900, 687720, 5339920});
  const BlockFrame frame = images.frame();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> in(0.0, 1.0);
  for (int k = 0; k < 300; ++k) {
    const Eigen::Vector3d p(box.x0 + (box.x1 - box.x0) * in(random), box.y0 + (box.y1 - box.y0) * in(random), 400.0 + 300.0 * in(random));
    EXPECT_LT((patch(p) - frame.local_of(p)).norm(), 5e-5);
  }
  const Eigen::Vector3d p(687713.37, 5339907.91, 512.6);
  EXPECT_EQ(patch(p), smaller(p));  // to the last bit
}

TEST(LocalPatch, FeetAndABoxOfNoWidth) {
  OrientedImages images;
  images.map = {"EPSG:2263", 1200.0 / 3937.0, 1.0};
  images.middle = {980000, 200000, 300};
  const Eigen::Vector3d p(980000 * 1200.0 / 3937.0 + 12.0, 200000 * 1200.0 / 3937.0 - 7.0, 20.0);
  const LocalPatch patch(images, {p.x(), p.y(), p.x(), p.y()});
  EXPECT_LT((patch(p) - images.frame().local_of(images.map.in_units(p))).norm(), 5e-5);
  EXPECT_NEAR(patch(p).x(), 12.0, 0.2);  // metres, but for the turn and scale of the grid
}

TEST(LocalPatch, ALocalMapIsItself) {
  const LocalPatch patch(OrientedImages{}, {0, 0, 60, 40});
  const Eigen::Vector3d p(31.7, 22.2, 9.0);
  EXPECT_LT((patch(p) - p).norm(), 1e-12);
}

}  // namespace
}  // namespace swath::calib
