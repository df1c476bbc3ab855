// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/events_outside.h"

#include <gtest/gtest.h>

#include "core/config/result_visitors.h"

namespace swath::trajectory {
namespace {

const Span flight{1.4e9, 1.4e9 + 600};

/// Ten events a minute apart, beginning 30 s after the flight and `off` s later.
std::vector<double> ten(double off) {
  std::vector<double> out;
  for (int k = 0; k < 10; ++k) out.push_back(flight.first + 30 + 60 * k + off);
  return out;
}

TEST(EventsOutside, NearlyAllOfThemAreNamedWithBothSpans) {
  EXPECT_FALSE(outside_of("marks", ten(0), flight, "the trajectory"));
  EXPECT_FALSE(outside_of("marks", {}, flight, "the trajectory"));
  // 17 s, and a minute and a half, leave most within.
  EXPECT_FALSE(outside_of("marks", ten(-17), flight, "the trajectory"));
  EXPECT_FALSE(outside_of("marks", ten(90), flight, "the trajectory"));
  EXPECT_FALSE(outside_of("marks", ten(-480), flight, "the trajectory"));  // two within
  const auto one_within = outside_of("marks", ten(-540), flight, "the trajectory");
  ASSERT_TRUE(one_within);
  EXPECT_EQ(one_within->outside, 9u);
  EXPECT_NE(one_within->what.find("9 of 10 events of 'marks' lie outside the trajectory: events from 2024-05-17T"), std::string::npos)
      << one_within->what;
  EXPECT_NE(one_within->what.find(", the trajectory from 2024-05-17T16:53:02"), std::string::npos) << one_within->what;
  EXPECT_NE(one_within->cause.find("18 s ahead of UTC"), std::string::npos) << one_within->cause;
}

TEST(EventsOutside, TheUsualMistakeIsNamed) {
  const auto cause = [](double off) { return outside_of("pc", ten(off), flight, "the trajectory")->cause; };
  EXPECT_NE(cause(86400).find("1 day apart"), std::string::npos) << cause(86400);
  EXPECT_NE(cause(-86400 - 18).find("1 day apart"), std::string::npos) << cause(-86400 - 18);
  EXPECT_NE(cause(604800).find("1 week apart"), std::string::npos) << cause(604800);
  EXPECT_NE(cause(-7200).find("time zone"), std::string::npos) << cause(-7200);
}

TEST(EventsOutside, EachTechniqueByItself) {
  core::EventData events;
  for (const auto& [technique, off] : {std::pair{"marks", 0.0}, {"pc", 86400.0}})
    for (const double t : ten(off)) events.time.push_back(t), events.technique.emplace_back(technique);
  const auto found = outside_of(events, flight, "the GNSS record");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].technique, "pc");
  EXPECT_EQ(found[0].events, 10u);
  const core::Value v = core::reported(found[0]);
  EXPECT_EQ(v.find("outside")->as_int(), 10);
  EXPECT_EQ(v.find("first_gps_s")->as_number(), flight.first + 86430);
  EXPECT_EQ(v.find("sentence")->as_text(), found[0].what + ": " + found[0].cause);
}

}  // namespace
}  // namespace swath::trajectory
