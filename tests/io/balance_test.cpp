// SPDX-License-Identifier: GPL-3.0-or-later
// Every reader accounts for the rows of its files: rows = kept + left out, by reason. The rows are counted here, as they are written.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <map>

#include "core/records/trajectory_columns.h"
#include "core/time.h"
#include "io/gnss/gnss_file.h"
#include "io/las/las_writer.h"
#include "io/records/clock_log.h"
#include "io/records/event_file.h"
#include "io/records/imu_file.h"
#include "io/records/laser_file.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_file.h"
#include "io/text/npy.h"
#include "io/vector/breaklines.h"
#include "io/vector/control.h"
#include "tests/io/las_sample.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// What a reader must say of a kind of records.
struct Expected {
  const char* kind;
  std::uint64_t read, kept;
};

struct Case {
  const char* name;
  /// Writes files, some of whose rows are at fault, and reads them.
  std::function<void(const test::TemporaryFolder&, Survey&, core::Tally&)> read;
  std::vector<Expected> expected;
};

/// `n` rows by their number, and what `instead` says in place of some.
std::string rows(const char* head, int n, const std::function<std::string(int)>& row, const std::map<int, std::string>& instead = {}) {
  std::string out = head;
  for (int k = 0; k < n; ++k) out += (instead.contains(k) ? instead.at(k) : row(k)) + "\n";
  return out;
}
std::string text(const char* format, double a, double b = 0.0) {
  char out[200];
  std::snprintf(out, sizeof out, format, a, b);
  return out;
}

const TimeTags week_2317{core::TimeScale::gps_week, 2317, ""};

LaserFile& laser_file(Survey& s, const std::filesystem::path& file) {
  LaserFile& f = s.laser.emplace_back();
  f.file = file;
  f.time = week_2317;
  f.angle_unit = AngleUnit::deg;
  f.columns.time = "t", f.columns.range = "r", f.columns.scan_angle = "a";
  s.line_time = week_2317;
  s.lines = {{3, "", core::Seconds(1010), core::Seconds(1020)}, {9, "", core::Seconds(1030), core::Seconds(1040)}};
  return f;
}

void read_laser(const Survey& s, core::Tally& tally) {
  for (const StripInfo& strip : scan(s, tally)) {
    LaserSource source(s, strip);
    core::Shots batch;
    while (source.next(batch, 70)) {
    }
    tally.add(source.tally());
  }
}

void laser_text(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  // The first line is only the end of a record; 200 rows lie in the two lines, four of them at fault, and one is of no time.
  const auto row = [](int k) { return text("%.1f,700.25,3.5", 1000 + 0.1 * k); };
  test::write_bytes(
      folder / "a.csv",
      "3.5\n" +
          rows("", 500, row,
               {{120, "1012.0,-1,3.5"}, {130, "1013.0,2e5,3.5"}, {140, "1014.0,nan,3.5"}, {150, "1015.0,700,900"}, {160, "9e5,700,3.5"}}));
  LaserFile& f = laser_file(s, folder / "a.csv");
  f.columns.time = "1", f.columns.range = "2", f.columns.scan_angle = "3";
  read_laser(s, tally);
}

void laser_npy(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  NpyWriter w(folder / "a.npy", {{"t", "f8"}, {"r", "f8"}, {"a", "f8"}});
  std::vector<double> t, r(500, 700.0), a(500, 3.5);
  for (int k = 0; k < 500; ++k) t.push_back(1000 + 0.1 * k);
  r[350] = 0.0, a[360] = std::nan("");
  w.append({t.data(), r.data(), a.data()}, 500);
  w.commit();
  laser_file(s, folder / "a.npy");
  read_laser(s, tally);
}

void laser_las(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  LasHeader h = test::sample_header(6);
  h.offset.setZero();
  LasPoints p = test::sample_points(h, 500);
  for (size_t i = 0; i < p.size(); ++i) {
    p.gps_time[i] = core::from_week(2317, 1000 + 0.1 * static_cast<double>(i)) - core::adjusted_offset;
    p.raw_x[i] = 0, p.raw_y[i] = 100, p.raw_z[i] = i == 110 ? 0 : 200000;
    if (i == 110) p.raw_y[i] = 0;  // range 0
  }
  test::write_sample(folder / "a.las", h, p);
  LaserFile& f = laser_file(s, folder / "a.las");
  f.time = {};
  f.columns = {};
  read_laser(s, tally);
}

void imu(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto row = [](int k) { return text("%.2f,0,0,%.6f,0,0,-9.8", 1000 + 0.01 * k, 1e-6 * k); };
  test::write_bytes(folder / "imu.csv",
                    rows("t,wx,wy,wz,fx,fy,fz\n", 400, row,
                         {{50, "1000.50,0,,0,0,0,-9.8"}, {60, row(59)}, {70, "5e5,0,0,0,0,0,-9.8"}, {80, "1000.80,0,900,0,0,0,-9.8"}}));
  ImuFile& f = s.imu.emplace_back();
  f.file = folder / "imu.csv", f.time = week_2317, f.kind = ImuKind::rates;
  f.angle_unit = AngleUnit::rad, f.acceleration_unit = AccelerationUnit::mps2;
  f.columns = {"t", "", "wx", "wy", "wz", "fx", "fy", "fz"};
  read_imu(s, tally);
}

GnssFile& gnss_file(Survey& s, const std::filesystem::path& file) {
  GnssFile& f = s.gnss.emplace_back();
  f.file = file, f.time = week_2317;
  f.columns.time = "t", f.columns.latitude = "lat", f.columns.longitude = "lon", f.columns.height = "h";
  return f;
}

void gnss_text(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto row = [](int k) { return text("%.0f,%.7f,11,500", 1000 + k, 48 + 1e-5 * k); };
  test::write_bytes(
      folder / "a.csv",
      rows("t,lat,lon,h\n", 400, row,
           {{50, "1050,nan,11,500"}, {60, row(59)}, {70, "5e5,48,11,500"}, {80, "1080,48,11,9e9"}, {90, "1090,48.5,11,500"}}));
  gnss_file(s, folder / "a.csv");
  read_gnss(s, tally);
}

void gnss_pos(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const char* head = "%  GPST          latitude(deg) longitude(deg)  height(m)   Q  ns\n";
  const auto row = [](int k) { return text("2317 %.3f   %.9f  -105.250000000  1600.0000   1  21", 1000 + k, 40 + 1e-5 * k); };
  test::write_bytes(folder / "a.pos",
                    rows(head, 300, row, {{50, "what is this"}, {60, row(59)}, {70, "2317 1070.000 40.0 -105.25 1600 0 0"}}));
  s.gnss.emplace_back().file = folder / "a.pos";
  read_gnss(s, tally);
}

std::string sentence(const std::string& words) {
  unsigned sum = 0;
  for (const char c : words) sum ^= static_cast<unsigned char>(c);
  char end[8];
  std::snprintf(end, sizeof end, "*%02X", sum);
  return "$" + words + end;
}

void gnss_nmea(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto gga = [](int k, int quality) {
    char time[32];
    std::snprintf(time, sizeof time, "10%02d%02d.00", k / 60, k % 60);
    return sentence("GNGGA," + std::string(time) + ",4830.0000,N,01115.0000,W," + std::to_string(quality) + ",12,0.9,500.25,M,46.8,M,,");
  };
  const auto row = [&](int k) { return gga(k, 4); };
  const std::string date = sentence("GNRMC,100000.00,A,4830.0000,N,01115.0000,W,0.1,2.0,060624,,,A") + "\n";
  test::write_bytes(folder / "a.nmea",
                    rows(date.c_str(), 300, row,
                         {{50, gga(50, 0)}, {60, "$" + row(61).substr(2)}, {70, "binary"}, {80, row(79)}, {90, "$GNGGA,100130.00,48*00"}}));
  s.gnss.emplace_back().file = folder / "a.nmea";
  s.gnss.back().format = GnssFormat::nmea;
  read_gnss(s, tally);
}

std::string pose(int k) { return text("%.2f,48,%.9f,900,1,2,30", 1000 + 0.01 * k, 11 + 5e-6 * k); }

void trajectory_text(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  for (const char* name : {"a.csv", "b.csv"}) {  // b goes on where a ends, at the same time
    const int first = *name == 'a' ? 0 : 399;
    test::write_bytes(
        folder / name,
        rows("t,lat,lon,h,roll,pitch,heading\n", 400, [&](int k) { return pose(first + k); },
             {{50, "nan,48,11,900,1,2,30"}, {60, pose(first + 59)}, {70, text("%.2f,,11,900,1,2,30", 1000.7 + 0.01 * first)}}));
    TrajectoryFile& f = s.trajectory.emplace_back();
    f.file = folder / name, f.format = TrajectoryFormat::text, f.time = week_2317, f.angle_unit = AngleUnit::deg;
    f.columns.time = "t", f.columns.latitude = "lat", f.columns.longitude = "lon", f.columns.height = "h";
    f.columns.roll = "roll", f.columns.pitch = "pitch", f.columns.heading = "heading";
  }
  read_trajectory(s, tally);
}

void trajectory_sbet(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  core::TrajectoryData t;
  core::for_each_trajectory_column([&](auto member, const char*) { (t.*member).assign(400, 0.01f); });
  for (int k = 0; k < 400; ++k) {
    const auto i = static_cast<size_t>(k);
    t.time[i] = core::from_week(2317, 1000 + 0.01 * k), t.latitude[i] = 0.8, t.longitude[i] = 0.2 + 1e-7 * k, t.height[i] = 900;
  }
  t.height[50] = std::nan("");
  t.height[60] = 5e6;
  t.sigma_north[70] = -1.0f;
  write_sbet(folder / "a.out", t);
  write_smrmsg(folder / "a.smrmsg", t);
  TrajectoryFile& f = s.trajectory.emplace_back();
  f.file = folder / "a.out", f.accuracy = folder / "a.smrmsg", f.format = TrajectoryFormat::sbet, f.time = week_2317;
  f.velocity_axes = VelocityAxes::ignore;
  read_trajectory(s, tally);
}

void clock_loopstats(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto row = [](int k) { return text("54921 %.1f 0.001 13.7 0.0003 0.01 6", 1000 + 16.0 * k); };
  test::write_bytes(folder / "log", rows("", 40, row, {{10, row(9)}, {20, row(3)}, {21, row(3)}}));
  s.clock.emplace_back().file = folder / "log";
  read_clock_logs(s, tally);
}

void clock_peerstats(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto row = [](int k) {
    return text("54921 %.0f ", 1000 + 16.0 * k) + (k % 4 ? "10.0.0.2 9324" : "127.127.20.0 9614") + " 0.001 0.0 0.002 0.0003";
  };
  test::write_bytes(folder / "log", rows("", 40, row));
  s.clock.emplace_back().file = folder / "log";
  s.clock.back().format = ClockFormat::peerstats;
  read_clock_logs(s, tally);
}

void events(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  test::write_bytes(folder / "events.csv", rows("t\n", 20, [](int k) { return text("%.3f", 1000 + k); }));
  EventFile& f = s.events.emplace_back();
  f.file = folder / "events.csv", f.time = week_2317, f.columns.time = "t";
  read_event_files(s, tally);
}

void control(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  // A target whose ring is closed, one that loses a corner, and points.
  std::string all = "name,target,x,y,z\n";
  for (const char* corner : {"500100,5300200,480", "500130,5300200,480", "500130,5300220,484", "500100,5300220,484", "500100,5300200,480"})
    all += std::string(",hall,") + corner + "\n";
  for (const char* corner : {"500200,5300200,480", "500230,5300200,480", "nan,5300220,484"}) all += std::string(",barn,") + corner + "\n";
  all += rows("", 200, [](int k) { return text("p%.0f,,%.1f,5300300,470", k, 500000 + k); });
  test::write_bytes(folder / "control.csv", all);
  s.crs = "EPSG:32632";
  s.control.emplace_back().file = folder / "control.csv";
  read_control(s, tally);
}

void breaklines(const test::TemporaryFolder& folder, Survey& s, core::Tally& tally) {
  const auto feature = [](const std::string& geometry) { return R"({"type":"Feature","properties":{},"geometry":)" + geometry + "}"; };
  const std::string line = R"({"type":"LineString","coordinates":[[9,48,400],[9.001,48,401]]})";
  const std::string point = R"({"type":"LineString","coordinates":[[9,48,400],[9,48,401]]})";
  test::write_bytes(folder / "edges.geojson", R"({"type":"FeatureCollection","features":[)" + feature(line) + "," + feature("null") + "," +
                                                  feature(point) + "," + feature(line) + "]}");
  s.crs = "EPSG:32632";
  s.breaklines.emplace_back().file = folder / "edges.geojson";
  read_breaklines(s, s.crs, tally);
}

class Balance : public ::testing::TestWithParam<Case> {};

TEST_P(Balance, RowsOfTheFileAreKeptOrLeftOut) {
  const test::TemporaryFolder folder;
  Survey survey;
  core::Tally tally;
  GetParam().read(folder, survey, tally);
  EXPECT_EQ(tally.unbalanced(), "");
  ASSERT_EQ(tally.records().size(), GetParam().expected.size());
  for (const Expected& e : GetParam().expected) {
    bool found = false;
    for (const core::RecordCount& r : tally.records()) {
      if (r.name != e.kind) continue;
      found = true;
      EXPECT_EQ(r.read, e.read) << e.kind;
      EXPECT_EQ(r.kept, e.kept) << e.kind;
      EXPECT_EQ(r.left_out, e.read - e.kept) << e.kind;
    }
    EXPECT_TRUE(found) << e.kind;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Readers, Balance,
    ::testing::Values(Case{"laser_text", laser_text, {{"records", 501, 197}}}, Case{"laser_npy", laser_npy, {{"records", 500, 200}}},
                      Case{"laser_las", laser_las, {{"records", 500, 201}}}, Case{"imu", imu, {{"IMU records", 400, 396}}},
                      Case{"gnss_text", gnss_text, {{"GNSS fixes", 400, 395}}},
                      Case{"gnss_pos", gnss_pos, {{"RTKLIB lines", 300, 298}, {"GNSS fixes", 298, 297}}},
                      Case{
                          "gnss_nmea",
                          gnss_nmea,
                          {{"NMEA lines", 301, 300}, {"NMEA sentences", 300, 298}, {"NMEA positions", 297, 296}, {"GNSS fixes", 296, 295}}},
                      Case{"trajectory_text", trajectory_text, {{"trajectory records", 800, 793}}},
                      Case{"trajectory_sbet", trajectory_sbet, {{"trajectory records", 400, 398}, {"smrmsg records", 400, 399}}},
                      Case{"clock_loopstats", clock_loopstats, {{"clock records", 40, 19}}},
                      Case{"clock_peerstats", clock_peerstats, {{"clock records", 40, 10}}}, Case{"events", events, {{"events", 20, 20}}},
                      Case{"control", control, {{"control points", 208, 204}}},
                      Case{"breaklines", breaklines, {{"breakline features", 4, 2}}}),
    [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace swath::io
