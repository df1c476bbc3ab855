// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/shifted_strip.h"

#include <gtest/gtest.h>

#include "calib/block/checks/block_mistakes.h"
#include "core/error.h"
#include "tests/calib/block/made_block.h"

namespace swath::calib {
namespace {

constexpr double times = 1.4;

ReadBlock made(int strips, int images) {
  test::Making making;
  making.layout.strips = strips, making.layout.images = images;
  making.attitudes = true, making.boresight.setZero();
  ReadBlock out;
  out.block = test::make_block(making).given;
  out.stations_observed = out.block.stations.size();
  return out;
}

std::string refusal(const ReadBlock& read) {
  try {
    refuse_shifted_strip(read, BlockConfig(), times);
  } catch (const core::Error& e) {
    return e.text();
  }
  return {};
}

/// Images of a strip, those from `first` on at the place of another.
std::vector<std::uint32_t> shift(ReadBlock& read, int strip, size_t first, int step) {
  const std::vector<std::uint32_t> images = flown(read.block, strip);
  const std::vector<Eigen::Vector3d> places = positions_of_next(read.block, images, step);
  for (size_t k = first; k < images.size(); ++k) read.block.images[images[k]].position = places[k];
  return images;
}

/// The image that the shift begins with has lost its own place: with the place before it or after it, it is one base off.
bool names_shift_from(const std::string& found, const ReadBlock& read, const std::vector<std::uint32_t>& images, size_t first) {
  for (const size_t k : {first, first + 1})
    if (found.find("the stations of strip " + std::to_string(read.block.images[images[k]].strip) + " from image " +
                   read.block.images[images[k]].name + " on are those of the image after") != std::string::npos)
      return true;
  return false;
}

/// One strip of many is a small part of all residuals, and none of the first points.
TEST(ShiftedStrip, OneOfManyIsNamed) {
  ReadBlock read = made(20, 10);
  ASSERT_EQ(refusal(read), "");
  const int strip = read.block.images.back().strip;
  const std::vector<std::uint32_t> images = shift(read, strip, 4, 1);
  const std::string found = refusal(read);
  EXPECT_TRUE(names_shift_from(found, read, images, 4)) << found;
}

TEST(ShiftedStrip, ShiftsEitherWay) {
  for (const int step : {1, -1}) {
    ReadBlock read = made(6, 8);
    const int strip = read.block.images[20].strip;
    shift(read, strip, 0, step);
    const std::string found = refusal(read);
    EXPECT_NE(found.find("the stations of strip " + std::to_string(strip) + " are those of the image " + (step > 0 ? "after" : "before")),
              std::string::npos)
        << found;
  }
}

/// All images in one strip, as where a table does not part them: each trial costs what one image costs.
TEST(ShiftedStrip, OneLongStrip) {
  ReadBlock read = made(40, 40);
  for (BlockImage& i : read.block.images) i.strip = 1;
  ASSERT_EQ(refusal(read), "");
  const std::vector<std::uint32_t> images = shift(read, 1, 700, 1);
  const std::string found = refusal(read);
  EXPECT_TRUE(names_shift_from(found, read, images, 700)) << found;
}

}  // namespace
}  // namespace swath::calib
