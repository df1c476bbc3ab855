// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/events.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "io/text/delimited.h"
#include "simulate/planned_flight.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

const core::Geodetic origin{48 * core::degree, 10.5 * core::degree, 600.0};

PlannedFlight flight() {
  FlightOptions o;
  o.line_length = core::Metres(2000.0);
  return PlannedFlight(o, origin, 950.0, plan_lines(o, {}, 0.3, 0.0), 5.2, 1);
}

std::vector<std::vector<double>> rows_of(const std::filesystem::path& file) {
  std::vector<std::vector<double>> out;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    std::vector<double> row;
    for (double v = 0; words >> v;) row.push_back(v);
    if (!row.empty()) out.push_back(row);
  }
  return out;
}

TEST(Events, LieOnTheirLines) {
  const PlannedFlight f = flight();
  const std::vector<Event> events = plan_events(f, {}, 1);
  EXPECT_GE(events.size(), 4u * 8u);
  for (size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].id, static_cast<int>(i) + 1);
    const Line& line = f.lines()[static_cast<size_t>(events[i].line) - 1];
    EXPECT_GT(events[i].t, line.start);
    EXPECT_LT(events[i].t, line.end);
    if (i > 0 && events[i].line == events[i - 1].line) {
      EXPECT_NEAR(events[i].t - events[i - 1].t, 4.0, 0.17);
    }
  }
}

TEST(Events, DaysAndSecondsAreThoseOfUtc) {
  // 2009-03-31T11:00:00 UTC is week 1525, 212415 s: GPS - UTC was 15 s. MJD 54921.
  const core::GpsTime start = core::from_week(1525, 212415.0);
  EXPECT_EQ(utc_day(start, 0.0).mjd, 54921);
  EXPECT_NEAR(utc_day(start, 0.0).second, 39600.0, 1e-9);
  EXPECT_NEAR(utc_day(start, 620.0256686).second, 40220.0256686, 1e-10);
  EXPECT_EQ(utc_day(start, 46800.0).mjd, 54922);  // midnight
  EXPECT_NEAR(utc_day(start, 46800.0, 2e-3).second, 2e-3, 1e-9);
  EXPECT_EQ(utc_day(core::from_week(2317, 5.0), 0.0).mjd, 44244 + 7 * 2317 - 1);  // still the Saturday before
}

/// Offset of the log at a clock's reading, linear between its records.
double offset_at(const std::vector<std::vector<double>>& log, double mjd_second) {
  for (size_t i = 0; i + 1 < log.size(); ++i) {
    const double a = log[i][0] * 86400 + log[i][1], b = log[i + 1][0] * 86400 + log[i + 1][1];
    if (mjd_second >= a && mjd_second <= b) return log[i][2] + (log[i + 1][2] - log[i][2]) * (mjd_second - a) / (b - a);
  }
  ADD_FAILURE() << "outside the log";
  return 0;
}

TEST(Events, LogsCorrectTheComputersTagsToTheTruth) {
  const PlannedFlight f = flight();
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder / "truth");
  const core::GpsTime start = core::from_week(2317, 345600.0 + 18.0 - 200.0);  // passes midnight UTC
  EventOptions o;
  const std::int64_t n = write_events(folder.path(), f, start, o, false, 4);
  const auto pc = rows_of(folder / "events_pc.csv"), marks = rows_of(folder / "events_marks.csv"),
             truth = rows_of(folder / "truth/events.csv"), log = rows_of(folder / "loopstats"), pulses = rows_of(folder / "pps.log");
  ASSERT_EQ(static_cast<size_t>(n), pc.size());
  ASSERT_EQ(marks.size(), pc.size());
  ASSERT_EQ(truth.size(), pc.size());
  for (const auto& row : log) ASSERT_EQ(row.size(), 7u);
  double square = 0, mark_square = 0, largest_raw = 0;
  for (size_t i = 0; i < pc.size(); ++i) {
    const double utc = std::fmod(truth[i][2] - 18.0, 86400.0);
    double raw = pc[i][2] - utc;
    if (raw < -43200) raw += 86400;
    EXPECT_NEAR(raw, truth[i][3], 8 * o.tag_noise.value);
    largest_raw = std::max(largest_raw, std::abs(raw));
    const double day = 44244.0 + 7 * 2317 + std::floor((truth[i][2] - 18.0) / 86400.0);
    const double mended = raw + offset_at(log, day * 86400 + pc[i][2]);
    square += mended * mended;
    mark_square += std::pow(marks[i][2] - truth[i][2], 2);
    EXPECT_LT(std::abs(mended), 5 * o.clock.jitter.value) << i;
  }
  const double rms = std::sqrt(square / static_cast<double>(n));
  EXPECT_LT(rms, o.clock.jitter.value + o.tag_noise.value);
  EXPECT_GT(rms, 0.3 * o.clock.jitter.value);
  EXPECT_GT(largest_raw, 2e-5);  // there was something to mend
  EXPECT_NEAR(std::sqrt(mark_square / static_cast<double>(n)), 50e-9, 25e-9);
  // Pulses come with the whole second: what the clock shows beyond it is its error.
  ASSERT_GE(pulses.size(), static_cast<size_t>(f.duration() + 899));
  for (size_t i = 0; i < pulses.size(); i += 7) {
    const double beyond = pulses[i][1] - std::round(pulses[i][1]);
    EXPECT_NEAR(beyond, -offset_at(log, pulses[i][0] * 86400 + pulses[i][1]), 5 * (o.clock.jitter.value + o.tag_noise.value)) << i;
  }
}

TEST(Events, SurveyTellsScalesAndClock) {
  const PlannedFlight f = flight();
  const core::GpsTime start = core::from_week(2317, 604700.0);  // events lie in the next week, and count on
  const std::vector<io::EventFile> told = describe_events(f, start, {}, 1);
  ASSERT_EQ(told.size(), 2u);
  EXPECT_TRUE(told[0].computer_clock);
  EXPECT_EQ(told[0].time.scale, core::TimeScale::utc_day);
  EXPECT_EQ(told[1].time.week, 2317);
  ASSERT_EQ(describe_clocks().size(), 1u);
  EXPECT_EQ(describe_clocks()[0].format, io::ClockFormat::loopstats);
}

}  // namespace
}  // namespace swath::simulate
