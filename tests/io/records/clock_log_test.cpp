// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/clock_log.h"

#include "core/error.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double midnight_gps = 922492815.0;  // GPS time of 2009-03-31T00:00:00 UTC = week 1525, 172815 s

class ClockLogs : public ::testing::Test {
 protected:
  core::ClockData read(const std::string& text, ClockFormat format = ClockFormat::loopstats) {
    test::write_bytes(folder_ / "log", text);
    return read_clock_log(folder_ / "log", format, tally_);
  }
  std::string where_of(const std::string& text, ClockFormat format = ClockFormat::loopstats) {
    try {
      read(text, format);
    } catch (const core::Error& e) {
      EXPECT_FALSE(e.hint().empty()) << e.text();
      return e.where().substr(e.where().rfind('/') + 1);
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  core::Tally tally_;
};

TEST_F(ClockLogs, LoopstatsAsTheDaemonWritesThem) {
  const core::ClockData c = read(
      "54921 75440.031 0.000006019 13.778190 0.000351733 0.013380 6\n"
      "54921 75504.031 -0.000008 13.78 0.000200 0.013380 6\n");
  EXPECT_EQ(c.epoch, midnight_gps);
  EXPECT_EQ(c.time, (std::vector<double>{75440.031, 75504.031}));
  EXPECT_EQ(c.offset, (std::vector<double>{0.000006019, -0.000008}));
  EXPECT_EQ(c.jitter, (std::vector<double>{0.000351733, 0.0002}));
}

TEST_F(ClockLogs, OldLoopstatsHaveNoJitter) {
  const core::ClockData c = read("54921 10847.650 0.0001307 17.3478 2\n");
  EXPECT_EQ(c.offset, (std::vector<double>{0.0001307}));
  EXPECT_TRUE(c.jitter.empty());
}

TEST_F(ClockLogs, CommasTabsHeadersCommentsAndOtherOrders) {
  const char* forms[] = {"mjd,utc_sec_of_day,offset_s,freq_ppm,jitter_s\n54921,10,0.5,1,0.25\n",
                         "\xEF\xBB\xBF# a log\r\n\r\njitter\toffset\tSeconds\tMJD\r\n0.25\t0.5\t10\t54921\r\n", "54921;10;0.5;1;0.25;6",
                         "  54921   10 +0.5\t1  0.25 0 6\n"};
  for (const char* form : forms) {
    const core::ClockData c = read(form);
    ASSERT_EQ(c.size(), 1u) << form;
    EXPECT_EQ(c.time[0], 10) << form;
    EXPECT_EQ(c.offset[0], 0.5) << form;
    EXPECT_EQ(c.jitter[0], 0.25) << form;
  }
}

TEST_F(ClockLogs, TheDayChanges) {
  const core::ClockData c = read("54921 86390 1 0 0 0 6\n54922 6 2 0 0 0 6\n54922 86410 3 0 0 0 6\n54924 20 4 0 0 0 6\n");
  EXPECT_EQ(c.time, (std::vector<double>{86390, 86406, 86400 + 86410, 3 * 86400 + 20}));
  // Over the leap second of 2016 GPS counts one second more than the clock's own second of day.
  const core::ClockData leap = read("57753 86390 1 0 0 0 6\n57754 6 2 0 0 0 6\n");
  EXPECT_EQ(leap.time[1] - leap.time[0], 17.0);
}

TEST_F(ClockLogs, PeerstatsTakeTheSourceThatSteersTheClock) {
  // Status words: configured and reachable with selection 4 (candidate), 6 (system peer), 7 (PPS peer).
  const std::string candidate = "54921 10 10.0.0.1 9414 0.1 0.2 0.3 0.4\n", system = "54921 11 10.0.0.2 961a 0.5 0.2 0.3 0.04\n";
  const std::string pps = "54921 12 127.127.22.0 971a 0.7 0 0.3 0.004\n";
  const core::ClockData s = read(candidate + system, ClockFormat::peerstats);
  EXPECT_EQ(s.offset, (std::vector<double>{0.5}));
  EXPECT_EQ(s.jitter, (std::vector<double>{0.04}));
  EXPECT_EQ(tally_.of("clock records of sources that did not steer the clock, left out"), 1u);
  EXPECT_EQ(read(candidate + system + pps, ClockFormat::peerstats).offset, (std::vector<double>{0.7}));
  // The short form ends with the jitter; a single source never selected is taken whole.
  const core::ClockData one = read("54921 10 127.127.4.1 9014 -0.001605 0.00000 0.00142\n", ClockFormat::peerstats);
  EXPECT_EQ(one.offset, (std::vector<double>{-0.001605}));
  EXPECT_EQ(one.jitter, (std::vector<double>{0.00142}));
  EXPECT_EQ(where_of(candidate + "54921 11 10.0.0.2 9414 0.5 0.2 0.3 0.04\n", ClockFormat::peerstats), "log");
  EXPECT_EQ(where_of("54921 10 10.0.0.1 94zz 0.1 0.2 0.3 0.4\n54921 10 1 1 1 1 1\n", ClockFormat::peerstats), "log:1");
}

TEST_F(ClockLogs, PulsesStandOnWholeSeconds) {
  const core::ClockData two = read("54921 10.000125\n54921 10.99\n", ClockFormat::pps);
  EXPECT_NEAR(two.offset[0], -0.000125, 1e-12);
  EXPECT_NEAR(two.offset[1], 0.01, 1e-12);
  EXPECT_TRUE(two.jitter.empty());
  EXPECT_FALSE(two.steered);
  // POSIX seconds keep their nanoseconds.
  const core::ClockData one = read("1238457610.000000125#75\n1238457611.999999#76\n", ClockFormat::pps);
  EXPECT_EQ(one.epoch, midnight_gps);
  EXPECT_NEAR(one.time[0], 10.000000125, 1e-12);
  EXPECT_NEAR(one.offset[0], -1.25e-7, 1e-12);
  EXPECT_NEAR(one.offset[1], 1e-6, 1e-12);
  EXPECT_EQ(where_of("1238457610.5\n40000.1\n", ClockFormat::pps), "log:2");
}

TEST_F(ClockLogs, ALogOfAnotherFormatIsNamed) {
  const std::string loop = "54921 75440.031 0.000006019 13.778190 0.000351733 0.013380 6\n", old_loop = "54921 10847.650 0.00013 17.3 2\n";
  const std::string peer = "54921 10 10.0.0.1 961a 0.1 0.2 0.3 0.4\n", six = "54921 10 2001:db8::1 961a 0.1 0.2 0.3 0.4\n";
  const std::string pulses = "54921 10.000125\n", unix_pulses = "1238457610.000000125#75\n";
  const auto fault_of = [&](const std::string& text, ClockFormat format) {
    try {
      read(text, format);
    } catch (const core::Error& e) {
      EXPECT_EQ(e.where(), (folder_ / "log").string() + ":1");
      return std::string(e.what()) + " | " + e.hint();
    }
    return std::string("no error");
  };
  const auto expect = [&](const std::string& text, ClockFormat stated, const char* is) {
    const std::string fault = fault_of(text, stated);
    EXPECT_NE(fault.find(std::string("the form of ") + is + " | state format = \"" + is + "\""), std::string::npos) << fault;
  };
  for (const std::string& log : {loop, old_loop}) {
    expect(log, ClockFormat::pps, "loopstats");
    expect(log, ClockFormat::peerstats, "loopstats");
  }
  for (const std::string& log : {peer, six}) {
    expect(log, ClockFormat::pps, "peerstats");
    expect(log, ClockFormat::loopstats, "peerstats");
  }
  for (const std::string& log : {pulses, unix_pulses}) {
    expect(log, ClockFormat::loopstats, "pps");
    expect(log, ClockFormat::peerstats, "pps");
  }
  EXPECT_NE(fault_of("54921 10.000125 7\n", ClockFormat::pps).find("has 3 columns"), std::string::npos);
  EXPECT_EQ(read("54921 10.000125 # 75\n54921 11.000125 #76\n", ClockFormat::pps).size(), 2u);
}

TEST_F(ClockLogs, AClockSetBackLeavesOutWhatWasBefore) {
  const core::ClockData c =
      read("54921 100 1 0 0 0 6\n54921 116 2 0 0 0 6\n54921 110 3 0 0 0 6\n54921 110 4 0 0 0 6\n54921 126 5 0 0 0 6\n");
  EXPECT_EQ(c.offset, (std::vector<double>{3, 5}));
  EXPECT_EQ(tally_.of("clock records before the clock was set back, left out"), 2u);
  EXPECT_EQ(tally_.of("clock records at a repeated time, left out"), 1u);
}

TEST_F(ClockLogs, FaultsNameTheirLine) {
  const std::string good = "54921 10 0.1 0 0 0 6\n";
  EXPECT_EQ(where_of(good + "54921 11\n"), "log:2");
  EXPECT_EQ(where_of(good + "# c\n54921 11 0,1 0 0\n"), "log:3");
  EXPECT_EQ(where_of(good + "54921.5 11 0.1 0 0\n"), "log:2");
  EXPECT_EQ(where_of(good + "2009 11 0.1 0 0\n"), "log:2");
  EXPECT_EQ(where_of(good + "54921 999999 0.1 0 0\n"), "log:2");
  EXPECT_EQ(where_of(good + "54921 11 nan 0 0\n"), "log:2");
  EXPECT_EQ(where_of("mjd,sec,off\n54921,1,2\n"), "log:1");
  EXPECT_EQ(where_of("mjd,sec,offset_ms\n54921,1,2\n"), "log:1");
  EXPECT_EQ(where_of("mjd,sec,offset_s\n"), "log");
  EXPECT_EQ(where_of(""), "log");
}

TEST_F(ClockLogs, DailyLogsAreJoined) {
  test::write_bytes(folder_ / "b", "54922 6 2 0 0.2 0 6\n54922 22 3 0 0.3 0 6\n");
  test::write_bytes(folder_ / "a", "54921 86390 1 0 0.1 0 6\n");
  test::write_bytes(folder_ / "c", "54922 22 3 0 0.3 0 6\n");
  Survey survey;
  survey.folder = folder_.path();
  survey.clock = {{"b", ClockFormat::loopstats}, {"a", ClockFormat::loopstats}};
  const core::ClockData c = read_clock_logs(survey, tally_);
  EXPECT_EQ(c.epoch, midnight_gps);
  EXPECT_EQ(c.time, (std::vector<double>{86390, 86406, 86422}));
  EXPECT_EQ(c.jitter, (std::vector<double>{0.1, 0.2, 0.3}));
  survey.clock.push_back({"c", ClockFormat::loopstats});
  EXPECT_THROW(read_clock_logs(survey, tally_), core::Error);
  survey.clock[2] = {"c", ClockFormat::peerstats};
  EXPECT_THROW(read_clock_logs(survey, tally_), core::Error);
  survey.clock.clear();
  EXPECT_THROW(read_clock_logs(survey, tally_), core::Error);
}

TEST_F(ClockLogs, APulseBeyondTheYear2200IsNoTime) { EXPECT_EQ(where_of("1238544000.5\n2720854402085\n", ClockFormat::pps), "log:2"); }

TEST(ClockLogReference, LoopstatsWithAHeader) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p003_loopstats.csv");
  core::Tally tally;
  const core::ClockData c = read_clock_log(file, ClockFormat::loopstats, tally);
  ASSERT_EQ(c.size(), 220u);
  EXPECT_EQ(c.epoch, midnight_gps);
  EXPECT_EQ(c.time.front(), 39600);
  EXPECT_EQ(c.time.back(), 43104);
  EXPECT_EQ(c.offset.front(), -0.000903768);
  EXPECT_EQ(c.jitter.back(), 0.000004);
  EXPECT_TRUE(c.steered);
  EXPECT_TRUE(tally.empty());
}

}  // namespace
}  // namespace swath::io
