// SPDX-License-Identifier: GPL-3.0-or-later
#include "filters/pcl_messages.h"

#include <gtest/gtest.h>
#include <pcl/console/print.h>

namespace swath::filters {
namespace {

TEST(PclMessages, TheLevelIsWrittenOnce) {
  silence_pcl();
  pcl::console::setVerbosityLevel(pcl::console::L_ERROR);  // what a second write would undo
  silence_pcl();
  EXPECT_TRUE(pcl::console::isVerbosityLevelEnabled(pcl::console::L_ERROR));
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  silence_pcl();
  EXPECT_FALSE(pcl::console::isVerbosityLevelEnabled(pcl::console::L_ERROR));
}

}  // namespace
}  // namespace swath::filters
