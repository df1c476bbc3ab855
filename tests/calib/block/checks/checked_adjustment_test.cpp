// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/checked_adjustment.h"

#include <gtest/gtest.h>

#include "calib/block/checks/block_checks.h"
#include "core/error.h"
#include "tests/calib/block/made_files.h"

namespace swath::calib {
namespace {

TEST(CheckedAdjustment, ABlockIsAdjustedAndSummedUp) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  const std::string file = test::write_made(m, folder.path());
  const BlockConfig config = test::read_made(file);
  ReadBlock read = read_block(config, file);
  const ReadBlock before = read;
  const CheckedAdjustment a = adjust_checked(read, config);
  const StartResidual start = start_residual(before.block);
  EXPECT_EQ(a.found.start_tie, start.tie) << "fewer points than the sample";
  EXPECT_EQ(a.found.start_control, start.control);
  EXPECT_LT(a.found.image_rms, 1e3 * start.tie);  // um, mm
  EXPECT_EQ(a.found.images, before.block.images.size());
  for (size_t i = 0; i < before.block.images.size(); ++i) {
    EXPECT_EQ(a.stated.block.images[i].position, before.block.images[i].position);
    EXPECT_NE(read.block.images[i].position, before.block.images[i].position);
  }
}

TEST(CheckedAdjustment, MistakesAreRefusedAndNothingIsAdjusted) {
  const test::TemporaryFolder folder;
  test::MadeFiles m;
  m.block = test::make_block(test::small_making()).given;
  m.y = "down";
  const std::string file = test::write_made(m, folder.path());
  const BlockConfig config = test::read_made(file);
  ReadBlock read = read_block(config, file);
  const ReadBlock before = read;
  EXPECT_THROW(adjust_checked(read, config), core::Error);
  EXPECT_EQ(read.block.images[0].position, before.block.images[0].position);
}

}  // namespace
}  // namespace swath::calib
