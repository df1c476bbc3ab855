// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/block_sample.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

ReadBlock made() {
  test::Making making;
  making.layout.strips = 8, making.layout.images = 12;
  ReadBlock out;
  out.block = test::make_block(making).given;
  return out;
}

std::vector<int> points_by_image(const ImageBlock& block) {
  std::vector<int> out(block.images.size(), 0);
  for (const ImageRay& r : block.rays) ++out[r.image];
  return out;
}

TEST(BlockSample, EveryImageHasItsPoints) {
  constexpr int enough = 6;
  const ReadBlock read = made(), sample = sample_by_image(read, enough);
  ASSERT_LT(sample.block.points.size(), read.block.points.size());
  EXPECT_EQ(sample.block.images.size(), read.block.images.size());
  EXPECT_EQ(sample.block.control.size(), read.block.control.size());
  for (const int n : points_by_image(sample.block)) EXPECT_GE(n, enough);
  EXPECT_EQ(sample_by_image(read, 1000).block.rays.size(), read.block.rays.size());  // where there are no more
}

TEST(BlockSample, RaysAndControlAreOfTheSamePoints) {
  const ReadBlock read = made();
  for (const ReadBlock& sample : {sample_by_image(read, 6), sample_of(read, 50)}) {
    for (size_t k = 0; k < read.block.control.size(); ++k)
      EXPECT_EQ(sample.block.points[sample.block.control[k].point].name, read.block.points[read.block.control[k].point].name);
    for (const ImageRay& r : sample.block.rays) {
      const auto same = std::find_if(read.block.rays.begin(), read.block.rays.end(),
                                     [&](const ImageRay& o) { return o.image == r.image && o.x == r.x && o.y == r.y; });
      ASSERT_NE(same, read.block.rays.end());
      EXPECT_EQ(read.block.points[same->point].position, sample.block.points[r.point].position);
    }
  }
}

}  // namespace
}  // namespace swath::calib
