// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/event_marks.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/records/event_file.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

constexpr double tick = 1e-9;  // s: what the formats resolve

void put(std::string& to, std::uint64_t value, int bytes) {
  for (int k = 0; k < bytes; ++k) to.push_back(static_cast<char>(value >> (8 * k)));
}

/// One UBX message with its checksum.
std::string ubx(int kind, int id, const std::string& payload) {
  std::string body;
  put(body, static_cast<unsigned>(kind), 1), put(body, static_cast<unsigned>(id), 1), put(body, payload.size(), 2);
  body += payload;
  std::uint8_t a = 0, b = 0;
  for (const char c : body) a = static_cast<std::uint8_t>(a + static_cast<std::uint8_t>(c)), b = static_cast<std::uint8_t>(b + a);
  std::string out = "\xb5\x62" + body;
  put(out, a, 1), put(out, b, 1);
  return out;
}

constexpr unsigned rising = 0x80, valid = 0x40, utc = 0x20, base_gnss = 0x08, base_utc = 0x10, falling = 0x04;

std::string tim_tm2(unsigned flags, unsigned count, unsigned week, unsigned ms, unsigned ns, int input = 0) {
  std::string p;
  put(p, static_cast<unsigned>(input), 1), put(p, flags, 1), put(p, count, 2), put(p, week, 2), put(p, week, 2);
  put(p, ms, 4), put(p, ns, 4), put(p, ms + 20, 4), put(p, ns, 4), put(p, 35, 4);
  return ubx(0x0d, 0x03, p);
}

class EventMarks : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& name, const std::string& bytes) {
    test::write_bytes(folder_ / name, bytes);
    return folder_ / name;
  }
  template <class F>
  std::string fault_of(F&& f) {
    try {
      f();
    } catch (const core::Error& e) {
      return e.where().substr(e.where().rfind('/') + 1) + ": " + e.what();
    }
    return "no error";
  }
  test::TemporaryFolder folder_;
  core::Tally tally_;
};

TEST_F(EventMarks, UbxEdgesWithTheirCounter) {
  const unsigned good = rising | falling | valid | utc | base_gnss;
  const auto path = file("log.ubx", "noise" + ubx(0x01, 0x07, std::string(92, 'x')) + tim_tm2(good, 7, 2300, 1000123, 456789) +
                                        tim_tm2(valid | base_gnss, 7, 2300, 1000123, 456789) +  // no new edge
                                        tim_tm2(good, 8, 2300, 604799999, 999999) + tim_tm2(good, 11, 2301, 500, 0));
  const std::vector<EventMark> marks = read_ubx_marks(path, EventEdge::rising, 0, tally_);
  ASSERT_EQ(marks.size(), 3u);
  EXPECT_EQ(marks[0].second, 2300 * 604800.0 + 1000);
  EXPECT_NEAR(marks[0].fraction, 0.123456789, tick);
  EXPECT_NEAR(marks[1].second + marks[1].fraction - marks[2].second, -1e-9 + 0.0, 2.4e-7);  // the week's end is the next one's start
  EXPECT_NEAR(marks[0].sigma, 35e-9, 1e-15);
  EXPECT_EQ(marks[2].id, "11");
  EXPECT_FALSE(marks[0].doubtful);
  EXPECT_EQ(tally_.of("events that the receiver counted and did not record"), 2u);  // 9 and 10
  const std::vector<EventMark> down = read_ubx_marks(path, EventEdge::falling, 0, tally_);
  EXPECT_NEAR(down[0].fraction - marks[0].fraction, 0.020, tick);
}

TEST_F(EventMarks, UbxTimeBasesAndInputs) {
  const auto path =
      file("log.ubx", tim_tm2(rising | valid | base_utc, 1, 2300, 1000000, 0) + tim_tm2(rising | valid, 2, 2300, 2000000, 0) +
                          tim_tm2(rising | base_gnss, 3, 2300, 3000000, 0) + tim_tm2(rising | valid | base_gnss, 9, 2300, 4000000, 0, 1));
  const std::vector<EventMark> first = read_ubx_marks(path, EventEdge::rising, 1, tally_);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_EQ(first[0].second, 2300 * 604800.0 + 1000 + 18);  // UTC of 2024
  EXPECT_TRUE(first[1].doubtful);                           // the receiver's own clock
  EXPECT_EQ(tally_.of("events whose time is not valid, left out"), 1u);
  const std::vector<EventMark> second = read_ubx_marks(path, EventEdge::rising, 2, tally_);
  ASSERT_EQ(second.size(), 1u);
  EXPECT_EQ(second[0].id, "9");
}

TEST_F(EventMarks, DamagedUbxIsPassedOverAndOtherFilesAreRefused) {
  std::string one = tim_tm2(rising | valid | base_gnss, 1, 2300, 1000, 0), bad = tim_tm2(rising | valid | base_gnss, 2, 2300, 2000, 0);
  bad[12] = static_cast<char>(bad[12] ^ 1);
  const std::string last = tim_tm2(rising | valid | base_gnss, 3, 2300, 3000, 0);
  EXPECT_EQ(read_ubx_marks(file("a.ubx", one + bad + last + last.substr(0, 20)), EventEdge::rising, 0, tally_).size(), 2u);
  EXPECT_EQ(tally_.of("damaged UBX messages, passed over"), 2u);
  const auto read = [&](const std::string& bytes) { read_ubx_marks(file("b.ubx", bytes), EventEdge::rising, 0, tally_); };
  EXPECT_EQ(fault_of([&] { read(""); }), "b.ubx: holds no message of UBX");
  EXPECT_EQ(fault_of([&] { read("t,id\n1,2\n"); }), "b.ubx: holds no message of UBX");
  EXPECT_EQ(fault_of([&] { read(ubx(1, 7, "abc")); }), "b.ubx: holds no event: 1 message of UBX, 0 of them TIM-TM2");
}

// The maker's own example, with the CRC that it prints.
constexpr const char* novatel =
    "#MARKTIMEA,COM1,0,77.5,FINESTEERING,1358,422621.000,00000000,292e,2214;1358,422621.000000500,-1.398163614e-08,7.812745577e-08,"
    "-14.000000002,VALID*d8502226\r\n";

TEST_F(EventMarks, NovatelTakesTheReceiverClockOff) {
  const auto path = file("marks.txt", std::string("#BESTPOSA,COM1*00000000\n") + novatel);
  EXPECT_EQ(event_format(path), EventFormat::novatel);
  std::string settings;
  for (int k = 0; k < 200; ++k) settings += "#RXCONFIGA,COM1,0,77.5,FINESTEERING,2317,474006.000;#SETTINGA*12345678\n";
  EXPECT_EQ(event_format(file("late.txt", settings + novatel)), EventFormat::novatel) << "behind its settings";
  const std::vector<EventMark> marks = read_novatel_marks(path, 0, tally_);
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0].second, 1358 * 604800.0 + 422621);
  EXPECT_NEAR(marks[0].fraction, 5.00e-7 + 1.398163614e-08, 1e-12);
  EXPECT_NEAR(marks[0].sigma, 7.812745577e-08, 1e-15);
  EXPECT_FALSE(marks[0].doubtful);
  EXPECT_EQ(fault_of([&] { read_novatel_marks(path, 2, tally_); }), "marks.txt: holds no line of MARKTIME");
}

TEST_F(EventMarks, NovatelLinesOfAWrongCrcAreLeftOut) {
  std::string bad = novatel;
  bad[bad.find("422621.000000500") + 14] = '6';
  EXPECT_EQ(read_novatel_marks(file("a.txt", bad + novatel), 0, tally_).size(), 1u);
  EXPECT_EQ(tally_.of("damaged lines of MARKTIME, left out"), 1u);
  EXPECT_EQ(fault_of([&] { read_novatel_marks(file("b.txt", bad), 0, tally_); }), "b.txt: every line of MARKTIME is damaged");
  EXPECT_EQ(fault_of([&] { read_novatel_marks(file("c.txt", ""), 0, tally_); }), "c.txt: holds no line of MARKTIME");
}

constexpr const char* photo =
    "1\t400373.488877\t[2264]\t   -40,N\t     0,E\t    86,V\t44.42824637,Lat\t1.26196331,Lon\t359.494,Ellh\t0.028, 0.031, 0.055\t50,Q\n";

TEST_F(EventMarks, MrkGivesThePlaceOfTheAntenna) {
  const std::vector<EventMark> marks = read_mrk(file("x_Timestamp.MRK", photo), tally_);
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0].second, 2264 * 604800.0 + 400373);
  EXPECT_NEAR(marks[0].fraction, 0.488877, tick);
  // 4 cm north of the camera and 8.6 cm above it.
  const core::Geodetic antenna = core::geodetic_of(marks[0].place);
  EXPECT_NEAR((antenna.latitude - 44.42824637 * core::degree) * 6.368e6, 0.040, 1e-3);
  EXPECT_NEAR(antenna.height, 359.494 + 0.086, 1e-4);
  EXPECT_EQ(marks[0].place_sigma, Eigen::Vector3d(0.028, 0.031, 0.055));
  EXPECT_EQ(event_format(folder_ / "x_Timestamp.MRK"), EventFormat::mrk);
}

TEST_F(EventMarks, MrkLinesThatAreNoneHaveTheirPlace) {
  const std::string half = std::string(photo).substr(0, 60);
  EXPECT_EQ(fault_of([&] { read_mrk(file("a.MRK", photo + half + "\n"), tally_); }), "a.MRK:2: is no line of a Timestamp.MRK");
  EXPECT_EQ(fault_of([&] { read_mrk(file("b.MRK", ""), tally_); }), "b.MRK: no event");
  std::string no_fix = photo;
  no_fix.replace(no_fix.find("50,Q"), 4, "0,Q");
  const std::vector<EventMark> marks = read_mrk(file("c.MRK", no_fix), tally_);
  EXPECT_TRUE(marks[0].doubtful);
  EXPECT_FALSE(marks[0].place.allFinite());
}

constexpr const char* rinex3 =
    "     3.04           OBSERVATION DATA    G                   RINEX VERSION / TYPE\n"
    "                                                            END OF HEADER\n"
    "> 2020 06 10 12 00  0.0000000  0  1\nG05  20000000.000\n"
    "> 2020 06 10 12 00  0.2500000  5  0\n"
    "> 2020 06 10 12 00  0.7512346  5  1\nan exposure                                                 COMMENT\n"
    "> 2020 06 10 12 00  1.0000000  0  1\nG05  20000000.000\n"
    "> 2020 06 10 12 00  1.3000000  5  0\n";

TEST_F(EventMarks, RinexEventsOfFlagFive) {
  const auto path = file("rover.obs", rinex3);
  EXPECT_EQ(event_format(path), EventFormat::rinex);
  const std::vector<EventMark> marks = read_rinex_marks(path);
  ASSERT_EQ(marks.size(), 3u);  // two between one pair of epochs, one behind the last
  EXPECT_NEAR(marks[1].fraction, 0.7512346, 1e-8);
  EXPECT_EQ(marks[1].second, *core::gps_of_gps_date("2020-06-10", 43200));
  const std::string rinex2 =
      "     2.11           OBSERVATION DATA    G (GPS)             RINEX VERSION / TYPE\n"
      "     1    C1                                                # / TYPES OF OBSERV\n"
      "                                                            END OF HEADER\n"
      " 20  6 10 12  0  0.0000000  0  1G05\n  20000000.000\n"
      " 20  6 10 12  0  0.2500000  5  0\n 20  6 10 12  0  0.5000000  5  0\n"
      " 20  6 10 12  0  1.0000000  0  1G05\n  20000000.000\n";
  const std::vector<EventMark> old = read_rinex_marks(file("rover.20o", rinex2));
  ASSERT_EQ(old.size(), 2u);
  EXPECT_NEAR(old[1].fraction, 0.5, 1e-9);
  const std::string text = rinex3;
  EXPECT_EQ(fault_of([&] { read_rinex_marks(file("none.obs", text.substr(0, text.find("> 2020 06 10 12 00  0.25")))); }),
            "none.obs: no event: no epoch of flag 5");
}

TEST_F(EventMarks, AreEventsOfASurvey) {
  Survey survey;
  EventFile f;
  f.file = file("marks.MRK", photo);
  f.latency = core::Seconds(0.25);
  const core::EventTags tags = read_event_file(survey, f, tally_);
  EXPECT_EQ(tags.technique, "marks");
  ASSERT_EQ(tags.place.size(), 1u);
  const core::EventData events = events_of({tags});
  EXPECT_NEAR(events.time[0], 2264 * 604800.0 + 400373.738877, 2.4e-7);
  EXPECT_EQ(events.place[0], tags.place[0]);
}

}  // namespace
}  // namespace swath::io
