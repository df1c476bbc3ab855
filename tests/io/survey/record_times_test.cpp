// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/record_times.h"

#include <cmath>

#include "core/error.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double start = 1.4e9;  // GPS time of this century: 0.24 us is one place of it
constexpr double place = 3e-7;   // s

std::vector<double> even(size_t n, double step) {
  std::vector<double> t;
  for (size_t k = 0; k < n; ++k) t.push_back(start + static_cast<double>(k) * step);
  return t;
}

TEST(RecordTimes, RegularTimesAreLeftAlone) {
  std::vector<double> t = even(500, 0.005);
  const std::vector<double> as_recorded = t;
  const Cadence c = settle_times(t, {}, "a");
  EXPECT_NEAR(c.step, 0.005, place);
  EXPECT_FALSE(c.smoothed);
  EXPECT_TRUE(c.restarts.empty());
  EXPECT_EQ(t, as_recorded);
}

TEST(RecordTimes, RoundedStampsAreSmoothedAndFollowADriftingClock) {
  // 128 Hz stamped in whole milliseconds by a clock that gains 200 ppm over the file.
  std::vector<double> t, truth;
  for (size_t k = 0; k < 4000; ++k) {
    const double x = static_cast<double>(k) / 128;
    truth.push_back(start + x + 0.5 * 200e-6 * x * x / 31.25);
    t.push_back(start + std::floor((truth.back() - start) * 1e3 + 0.5) * 1e-3);
  }
  const Cadence c = settle_times(t, {}, "a");
  EXPECT_TRUE(c.smoothed);
  EXPECT_TRUE(c.restarts.empty());
  EXPECT_NEAR(c.jitter, 0.29e-3, 0.05e-3);  // a uniform error of 1 ms has 0.29 ms rms
  double squares = 0;
  for (size_t k = 0; k < t.size(); ++k) squares += (t[k] - truth[k]) * (t[k] - truth[k]);
  EXPECT_LT(std::sqrt(squares / static_cast<double>(t.size())), 0.06e-3);  // 0.29 ms over the root of 101, twice for its ends
  std::vector<double> kept = t;
  EXPECT_FALSE(settle_times(kept, {std::nullopt, false, false}, "a").smoothed);
}

TEST(RecordTimes, GapsAreFoundBesideJitterAndALateStampIsNone) {
  for (const double gap : {0.01, 0.25, 10.0}) {
    std::vector<double> t = even(400, 0.01);
    for (size_t k = 0; k < t.size(); ++k) t[k] += (k % 3 == 0 ? 1e-3 : 0) + (k >= 200 ? gap : 0);
    const Cadence c = settle_times(t, {}, "a");
    ASSERT_EQ(c.restarts, std::vector<size_t>{200}) << gap;
    EXPECT_TRUE(c.smoothed);
    EXPECT_NEAR(t[200] - t[199], gap + 0.01, 1e-3);
  }
  std::vector<double> t = even(400, 0.01);
  for (size_t k = 0; k < t.size(); ++k) t[k] += k % 2 ? 1e-3 : 0;
  t[200] += 0.008;
  EXPECT_TRUE(settle_times(t, {}, "a").restarts.empty());
}

TEST(RecordTimes, OfIncrementsAlreadyAShortGapCounts) {
  std::vector<double> t = even(400, 0.005);
  for (size_t k = 200; k < t.size(); ++k) t[k] += 0.001;
  std::vector<double> same = t;
  EXPECT_EQ(settle_times(t, {std::nullopt, true, true}, "a").restarts, std::vector<size_t>{200});
  EXPECT_TRUE(settle_times(same, {std::nullopt, true, false}, "a").restarts.empty());
}

TEST(RecordTimes, AStatedStepMustBeThatOfTheTimes) {
  std::vector<double> t = even(100, 0.01);
  EXPECT_EQ(settle_times(t, {0.0101, true, false}, "a").step, 0.0101);
  try {
    settle_times(t, {0.005, true, false}, "a.csv");
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_EQ(e.where(), "a.csv");
    EXPECT_NE(std::string(e.what()).find("0.005"), std::string::npos);
  }
  std::vector<double> one{start};
  EXPECT_THROW(settle_times(one, {}, "a"), core::Error);
  EXPECT_EQ(settle_times(one, {0.01, true, false}, "a").step, 0.01);
}

TEST(RecordTimes, TheLongestGapsAreTheExamples) {
  core::Tally tally;
  count_gaps({start, start + 10, start + 20, start + 30}, {start + 1, start + 15, start + 20.001, start + 32}, "gaps", tally);
  EXPECT_EQ(tally.of("gaps"), 4u);
  const core::Value told = tally.value();
  EXPECT_EQ(told.find("gaps")->find("examples")->items()[0].as_text().substr(0, 8), "5 s from");
}

TEST(RecordTimes, DatesBeforeTheCentury) {
  core::Tally tally;
  note_date(core::from_week(2317, 0), "a", tally);
  EXPECT_TRUE(tally.empty());
  note_date(core::from_week(2317 - 2048, 0), "a", tally);
  EXPECT_NE(tally.value().find("files dated before 2000: a GPS week number that rolled over at 1024?"), nullptr);
}

}  // namespace
}  // namespace swath::io
