// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/station_bases.h"

#include <gtest/gtest.h>

#include "tests/calib/block/checks/refusal.h"

namespace swath::calib {
namespace {

/// What a block is refused with whose positions in strip 1 are from its image `first` on those of the image `step` after.
std::string refused(size_t first, int step) {
  ReadBlock read;
  read.block = test::make_block(test::small_making()).truth;
  read.stations_observed = read.block.stations.size();
  std::vector<std::uint32_t> images;
  for (std::uint32_t i = 0; i < read.block.images.size(); ++i)
    if (read.block.images[i].strip == 1) images.push_back(i);
  const std::vector<BlockImage> at = read.block.images;
  for (size_t k = first; k < images.size(); ++k) {
    const auto n = static_cast<size_t>(static_cast<int>(k) + step);
    read.block.images[images[k]].position =
        n < images.size() ? at[images[n]].position : Eigen::Vector3d(2.0 * at[images[k]].position - at[images[k - 1]].position);
  }
  try {
    refuse_broken_bases(read, {});
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

TEST(StationBases, TiltedBlocksPass) {
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u}) {
    test::Making making = test::small_making();
    making.seed = seed;
    making.tilt = 0.06;
    const auto bases = station_bases(test::make_block(making).truth);
    ASSERT_GT(bases.size(), 10u);
    for (const StationBase& b : bases) {
      EXPECT_LT(b.ratio, 1.2) << seed;
      EXPECT_GT(b.ratio, 0.8) << seed;
    }
  }
}

TEST(StationBases, AMissingEventIsNamed) {
  const std::string text = refused(3, 1);
  EXPECT_NE(text.find("of strip 1 lie "), std::string::npos) << text;
  EXPECT_NE(text.find("may be missing"), std::string::npos) << text;
}

TEST(StationBases, AnEventTwiceIsNamed) {
  const std::string text = refused(3, -1);
  EXPECT_NE(text.find("an event may be listed twice"), std::string::npos) << text;
}

/// A drone that hovers: two images half a metre apart, whose stations say one and a half.
TEST(StationBases, ImagesOnOnePlaceAreNotJudged) {
  ReadBlock read;
  read.block = test::make_block(test::small_making()).truth;
  ImageBlock& b = read.block;
  read.stations_observed = b.stations.size() + 1;
  std::vector<std::uint32_t> images;
  for (std::uint32_t i = 0; i < b.images.size(); ++i)
    if (b.images[i].strip == 1) images.push_back(i);
  BlockImage second = b.images[images[2]];
  const Eigen::Vector3d way = (b.images[images[3]].position - second.position).normalized();
  second.time += 0.1 * (b.images[images[3]].time - second.time);
  second.position += 0.5 * way;
  const auto number = static_cast<std::uint32_t>(b.images.size());
  const std::vector<ImageRay> rays = b.rays;
  for (const ImageRay& r : rays) {
    if (r.image != images[2]) continue;
    const auto seen =
        image_of(b.cameras[0].value, b.cameras[0].distortion, second.camera_R_local * (b.points[r.point].position - second.position));
    b.rays.push_back({number, r.point, seen->x(), seen->y(), r.sigma});
  }
  second.position += way;
  b.images.push_back(second);
  EXPECT_NO_THROW(refuse_broken_bases(read, {}));
}

}  // namespace
}  // namespace swath::calib
