// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/pulse_border.h"

#include <gtest/gtest.h>

namespace swath::pipeline {
namespace {

TEST(PulseBorder, PulsesAreNeverCutAndNothingIsLost) {
  const std::vector<double> times = {1, 1, 2, 3, 3, 3, 4, 5, 5};
  for (size_t most = 1; most < 10; ++most) {
    PulseBorder border;
    std::vector<double> seen, seen_blocks;
    for (size_t from = 0; from < times.size(); from += most) {
      const bool last = from + most >= times.size();
      stages::StripBatch batch;
      for (size_t i = from; i < std::min(times.size(), from + most); ++i) {
        batch.shots.time.push_back(times[i]);
        batch.shots.record.push_back(static_cast<std::uint32_t>(i));
        batch.block.x.push_back(static_cast<double>(i));
        batch.block.y.push_back(0);
        batch.block.z.push_back(0);
        batch.block.time.push_back(times[i]);
      }
      border.cut(batch, last);
      if (!seen.empty() && batch.shots.size() > 0) {
        EXPECT_NE(seen.back(), batch.shots.time.front());
      }
      seen.insert(seen.end(), batch.shots.time.begin(), batch.shots.time.end());
      seen_blocks.insert(seen_blocks.end(), batch.block.x.begin(), batch.block.x.end());
    }
    EXPECT_EQ(seen, times);
    EXPECT_EQ(seen_blocks, (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8}));
  }
}

TEST(PulseBorder, ACloudWithoutTimesIsNotHeldBack) {
  constexpr size_t n = 1000;
  PulseBorder border;
  stages::StripBatch batch;
  for (auto* c : {&batch.block.x, &batch.block.y, &batch.block.z, &batch.block.time}) c->assign(n, 0.0);
  batch.shots.time.assign(n, 0.0);
  border.cut(batch, false);
  EXPECT_EQ(batch.block.size(), n);
  EXPECT_EQ(batch.shots.size(), n);
}

}  // namespace
}  // namespace swath::pipeline
