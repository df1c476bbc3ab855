// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/progress.h"

#include <gtest/gtest.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "io/text/value_file.h"

namespace swath::pipeline {
namespace {

TEST(Progress, Texts) {
  EXPECT_EQ(duration_text(3.44), "3.4 s");
  EXPECT_EQ(duration_text(72), "1 m 12 s");
  EXPECT_EQ(duration_text(3725), "1 h 02 m");
  EXPECT_EQ(count_text(840), "840");
  EXPECT_EQ(count_text(12.34e6), "12.34 M");
}

/// What `work` says as JSON, line by line.
template <class F>
std::vector<core::Value> said(const F& work) {
  testing::internal::CaptureStderr();
  {
    Progress p(Voice::json);
    work(p);
  }
  std::istringstream text(testing::internal::GetCapturedStderr());
  std::vector<core::Value> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(io::parse_json(line, "log"));
  return lines;
}

void pass(int milliseconds) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); }
constexpr int pause = 3400;  // ms, between two lines, with room for a machine that does other work

TEST(Progress, TheShareFollowsTheWorkAndNotTheCounts) {
  // A tile with one point is as much work as one of a million: a time left by counts would be a thousand hours.
  const auto lines = said([](Progress& p) {
    p.begin("terrain.dtm", 1'000'001, "points", 4.0);
    pass(200);
    p.advance(1, 1.0);
    pass(pause);
    p.advance(1'000'000, 3.0);
    p.end();
  });
  ASSERT_GE(lines.size(), 2u);  // of itself after three seconds, and at the end
  const core::Value& one = lines[0];
  EXPECT_EQ(one.find("done")->as_int(), 1);
  EXPECT_DOUBLE_EQ(one.find("share")->as_number(), 0.25);
  EXPECT_NEAR(one.find("seconds_left")->as_number(), 3.0 * one.find("seconds")->as_number(), 0.5);
}

TEST(Progress, AStepWithoutCountsSaysThatItIsAtWorkAndHowFarItIs) {
  const auto lines = said([](Progress& p) {
    p.expect({0.0, 0.0});
    p.begin("trajectory.ins_gnss", 0, "");
    pass(pause);
    p.share(0.5, "round 2");
    pass(pause);
    p.end();
  });
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0].find("share"), nullptr);
  EXPECT_EQ(lines[0].find("step")->as_int(), 1);
  EXPECT_EQ(lines[0].find("steps")->as_int(), 2);
  EXPECT_DOUBLE_EQ(lines[1].find("share")->as_number(), 0.5);
  EXPECT_EQ(lines[1].find("now")->as_text(), "round 2");
  EXPECT_EQ(lines[2].find("now"), nullptr);
  EXPECT_DOUBLE_EQ(lines[2].find("share")->as_number(), 1.0);
}

TEST(Progress, UntilTheNextShareIsSaidTheTimeLeftFalls) {
  const auto lines = said([](Progress& p) {
    p.begin("calib.adjust", 0, "");
    pass(2000);
    p.share(0.5, "round 1: planes");  // 2 s are left
    pass(pause - 2000);
    p.end();
  });
  ASSERT_EQ(lines.size(), 2u);
  ASSERT_NE(lines[0].find("seconds_left"), nullptr);
  EXPECT_NEAR(lines[0].find("seconds_left")->as_number() + lines[0].find("seconds")->as_number(), 4.0, 0.5);
}

TEST(Progress, ATimeLeftThatIsOverIsNotSaid) {
  const auto lines = said([](Progress& p) {
    p.begin("calib.adjust", 0, "");
    pass(100);
    p.share(0.5, "round 1: planes");  // 0.1 s are left
    pass(pause);
    p.end();
  });
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_DOUBLE_EQ(lines[0].find("share")->as_number(), 0.5);
  EXPECT_EQ(lines[0].find("seconds_left"), nullptr);
}

TEST(Progress, TheTimeLeftOfTheRunIsThatOfTheStepsToCome) {
  const auto lines = said([](Progress& p) {
    p.expect({1.0, 1.0, 8.0});
    p.begin("strips", 10, "returns");
    pass(200);
    p.advance(10);
    p.end();
    p.begin("filters.noise", 10, "points");
    p.skip(5);  // takes no time: half of the step is left
    pass(pause);
    p.advance(3);
    p.end();
  });
  ASSERT_GE(lines.size(), 3u);
  const core::Value& now = lines[lines.size() - 2];
  EXPECT_EQ(now.find("step")->as_int(), 2);
  // 0.2 s for 1.0 expected and the pause for 0.3 expected; left are 0.2 of this step and 8.0.
  const double of_step = 0.2 / 0.3 * pause / 1000.0, of_others = 8.0 * (0.2 + pause / 1000.0) / 1.3;
  EXPECT_NEAR(now.find("run_seconds_left")->as_number(), of_step + of_others, 1.0);
  EXPECT_NEAR(now.find("seconds_left")->as_number(), of_step, 0.2);
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

TEST(Progress, OneOfThemIsSingular) {
  const auto line = [](std::uint64_t n) {
    testing::internal::CaptureStderr();
    {
      Progress p(Voice::lines);
      p.begin("reading", n, "files");
      p.advance(n);
      p.end();
    }
    return testing::internal::GetCapturedStderr();
  };
  EXPECT_NE(line(1).find(" 1 file, "), std::string::npos) << line(1);
  EXPECT_NE(line(2).find(" 2 files, "), std::string::npos) << line(2);
}

TEST(Progress, AStoppedRunEndsAtItsNextStep) {
  Progress p(Voice::quiet);
  p.begin("work", 10, "points");
  p.advance(1);
  std::thread([&] { p.stop(); }).join();
  EXPECT_THROW(p.advance(1), Interrupted);
  EXPECT_THROW(p.skip(1), Interrupted);
  EXPECT_THROW(p.share(0.5), Interrupted);
  EXPECT_THROW(p.begin("more", 0, ""), core::SystemError);  // as such it leaves the work done so far
  p.end();
}

}  // namespace
}  // namespace swath::pipeline
