// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/event_file.h"

#include <cmath>

#include "core/error.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class EventFiles : public ::testing::Test {
 protected:
  EventFile file(const std::string& text) {
    test::write_bytes(folder_ / "events.csv", text);
    EventFile f;
    f.file = folder_ / "events.csv";
    f.technique = "marks";
    f.time = {core::TimeScale::gps_week, 1525, ""};
    f.columns = {"t", "name", "strip"};
    return f;
  }
  core::EventTags read(const EventFile& f) { return read_event_file(survey_, f, tally_); }
  std::string where_of(const EventFile& f) {
    try {
      read(f);
    } catch (const core::Error& e) {
      return e.where().substr(e.where().rfind('/') + 1);
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

TEST_F(EventFiles, NamesStripsAndTimesToTheirLastDigit) {
  EventFile f = file("name,t,strip\nIMG 01,213035.0168671,1\n\"IMG,02\",604800.25,2\n");
  f.latency = core::Seconds(0.5);
  const core::EventTags e = read(f);
  EXPECT_EQ(e.technique, "marks");
  EXPECT_EQ(e.epoch, 1525 * 604800.0 + 213035);
  EXPECT_NEAR(e.time[0], 0.0168671, 1e-10);
  EXPECT_EQ(e.time[1], 604800.25 - 213035);
  EXPECT_EQ(e.id, (std::vector<std::string>{"IMG 01", "IMG,02"}));
  EXPECT_EQ(e.strip, (std::vector<std::int32_t>{1, 2}));
  const core::EventData all = events_of({e});
  EXPECT_NEAR(all.time[0], 1525 * 604800.0 + 213035.5168671, 1.2e-7);
  EXPECT_EQ(all.technique[1], "marks");
  EXPECT_EQ(all.doubtful, (std::vector<std::uint8_t>{0, 0}));
}

TEST_F(EventFiles, ColumnsByNumberAndHeaderInAComment) {
  EventFile f = file("7 a\n8 b\n");
  f.columns = {"1", "", ""};
  f.technique.clear();
  EXPECT_EQ(read(f).id, (std::vector<std::string>{"1", "2"}));
  EXPECT_EQ(read(f).technique, "events");
  EXPECT_EQ(read(f).strip, (std::vector<std::int32_t>{0, 0}));
  f = file("second frame\n7 a\n8 b\n");
  f.columns = {"1", "2", ""};
  EXPECT_EQ(read(f).id, (std::vector<std::string>{"a", "b"}));
  f = file("# made by hand\n# t name\n7 a\n8 b\n");
  f.columns = {"t", "name", ""};
  EXPECT_EQ(read(f).id, (std::vector<std::string>{"a", "b"}));
  f = file("t|name\n7|a\n");
  f.columns = {"t", "name", ""};
  f.delimiter = "|";
  EXPECT_EQ(read(f).id, (std::vector<std::string>{"a"}));
}

TEST_F(EventFiles, EventsOfOneTimeAreCountedAndNamed) {
  const core::EventTags e = read(file("name,t,strip\na,10.25,1\nb,12.5,1\nc,10.25,2\nd,12.5,1\n"));
  EXPECT_EQ(e.size(), 4u);
  EXPECT_EQ(tally_.of("events at the time of another one"), 2u);
  const core::Value counted = tally_.value();
  EXPECT_EQ(counted.find("events at the time of another one")->find("examples")->items()[1].as_text(), "marks b and d");
}

TEST_F(EventFiles, EveryTimeScale) {
  // One instant, 2009-03-31T11:10:20.25 UTC, in each scale.
  const double gps = 1525 * 604800.0 + 213035.25;
  const struct {
    TimeTags tags;
    const char* text;
  } scales[] = {{{core::TimeScale::gps_week, 1525, ""}, "213035.25"},
                {{core::TimeScale::gps, {}, ""}, "922533035.25"},
                {{core::TimeScale::gps_adjusted, {}, ""}, "-77466964.75"},
                {{core::TimeScale::unix_utc, {}, ""}, "1238497820.25"},
                {{core::TimeScale::utc_day, {}, "2009-03-31"}, "40220.25"}};
  for (const auto& s : scales) {
    EventFile f = file("t,name,strip\n" + std::string(s.text) + ",a,1\n");
    f.time = s.tags;
    const core::EventTags e = read(f);
    EXPECT_EQ(e.epoch + e.time[0], gps) << s.text;
    EXPECT_EQ(e.epoch, std::floor(gps)) << s.text;
  }
}

TEST_F(EventFiles, UnitOffsetAndADevicesZero) {
  EventFile f = file("t,name,strip\n5250,a,1\n6000,b,1\n");
  f.time = {core::TimeScale::device, {}, ""};
  f.time.unit = core::Seconds(0.001);
  f.time.origin = "2009-03-31T11:10:35 GPS";
  f.time.origin_at = 1000;
  f.time.offset = core::Seconds(-0.125);
  const core::EventTags e = read(f);
  EXPECT_EQ(e.epoch, 1525 * 604800.0 + 213035 + 4);
  EXPECT_NEAR(e.time[0], 0.125, 1e-12);
  EXPECT_NEAR(e.time[1], 0.875, 1e-12);
}

TEST_F(EventFiles, MidnightIsFollowedAndFallingTimesAreCounted) {
  EventFile f = file("t,name,strip\n86399.5,a,1\n0.5,b,1\n0.25,c,1\n");
  f.time = {core::TimeScale::utc_day, {}, "2009-03-31"};
  f.computer_clock = true;
  const core::EventTags e = read(f);
  EXPECT_EQ(e.time[1] - e.time[0], 1.0);
  EXPECT_TRUE(e.computer_clock);
  EXPECT_EQ(tally_.of("events whose time is before the one before"), 1u);
  EXPECT_THROW(events_of({e}), core::Error);
}

TEST_F(EventFiles, FaultsNameTheirLine) {
  EXPECT_EQ(where_of(file("t,name,strip\n1,a,1\nx,a,1\n")), "events.csv:3");
  EXPECT_EQ(where_of(file("t,name,strip\n1,a,1\n\n2,a\n")), "events.csv:4");
  EXPECT_EQ(where_of(file("t,name,strip\n1,a,1.5\n")), "events.csv:2");
  EXPECT_EQ(where_of(file("t,name,strip\n1,a,1\n2,5,b,1\n")), "events.csv:3") << "a decimal comma";
  EXPECT_EQ(where_of(file("t,name,strip\n1,a,1,\n2,b,1,\n")), "no error") << "a delimiter at the end";
  EXPECT_EQ(where_of(file("t,name,strip\n-5,a,1\n")), "events.csv:2");
  EXPECT_EQ(where_of(file("time,name,strip\n1,a,1\n")), "events.csv");
  EXPECT_EQ(where_of(file("t,name,strip\n")), "events.csv");
  EventFile f = file("t,name,strip\n1717400000,a,1\n1717400001000,a,1\n");
  f.time.scale = core::TimeScale::unix_utc;
  EXPECT_EQ(where_of(f), "events.csv:3") << "milliseconds are no time of this century";
  f = file("t,name,strip\n1,a,1\n");
  f.time.scale = core::TimeScale::unstated;
  EXPECT_EQ(where_of(f), "events.csv");
  f = file("t,name,strip\n1,a,1\n");
  f.columns.time.clear();
  EXPECT_EQ(where_of(f), "events.csv");
  EXPECT_THROW(read_event_files(survey_, tally_), core::Error);
}

}  // namespace
}  // namespace swath::io
