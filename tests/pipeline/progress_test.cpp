// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/progress.h"

#include <gtest/gtest.h>

namespace swath::pipeline {
namespace {

TEST(Progress, Texts) {
  EXPECT_EQ(duration_text(3.44), "3.4 s");
  EXPECT_EQ(duration_text(72), "1 m 12 s");
  EXPECT_EQ(duration_text(3725), "1 h 02 m");
  EXPECT_EQ(count_text(840), "840");
  EXPECT_EQ(count_text(12.34e6), "12.34 M");
}

TEST(Progress, JsonIsOneObjectPerLineAndQuietIsQuiet) {
  testing::internal::CaptureStderr();
  {
    Progress p(Voice::json);
    p.begin("strips", 10, "returns");
    p.advance(10);
    p.end();
  }
  const std::string line = testing::internal::GetCapturedStderr();
  EXPECT_EQ(line.front(), '{');
  EXPECT_EQ(line.find('\n'), line.size() - 1);
  EXPECT_NE(line.find("\"finished\": true"), std::string::npos);
  testing::internal::CaptureStderr();
  {
    Progress p(Voice::quiet);
    p.begin("strips", 10, "returns");
    p.advance(10);
    p.say("text");
    p.end();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace swath::pipeline
