// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/text/cut_line.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "io/records/imu_file.h"
#include "io/text/delimited.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

class CutLine : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& text) {
    test::write_bytes(folder_ / "a.csv", text);
    return folder_ / "a.csv";
  }
  std::uint64_t cut_in(const std::string& text) { return inspect_delimited(made(text)).cut_line; }
  test::TemporaryFolder folder_;
};

/// Rows of a logger: time of the week, three rates, three forces.
std::string row(int k) {
  char text[160];
  std::snprintf(text, sizeof text, "%.3f,%.4f,%.4f,%.4f,%.3f,%.3f,%.3f\n", 208800 + 0.01 * k, 0.001 * (k % 7), -0.002,
                0.01 + 0.001 * (k % 3), 0.1, -0.05, -9.8 - 0.01 * (k % 5));
  return text;
}
std::string rows(int from, int until) {
  std::string out;
  for (int k = from; k < until; ++k) out += row(k);
  return out;
}

TEST_F(CutLine, WhereverTheFirstLineIsCutItIsLeftOutOrWhole) {
  const std::string first = row(0), rest = rows(1, 60);
  EXPECT_EQ(cut_in(first + rest), 0u);
  // Cut within its time, of the form 208800.000: each digit that is lost shows.
  for (size_t n = 1; n + 1 < first.size(); ++n) {
    const DelimitedLayout layout = inspect_delimited(made(first.substr(n) + rest));
    EXPECT_EQ(layout.cut_line, 1u) << first.substr(n);
    EXPECT_EQ(layout.columns, 7u);
    EXPECT_EQ(layout.delimiter, ',');
    EXPECT_TRUE(layout.names.empty());
    EXPECT_EQ(layout.data_line, 2u);
    EXPECT_EQ(layout.data_begin, first.size() - n);
  }
}

TEST_F(CutLine, WholeFilesStayAsTheyAre) {
  std::string counted, ratios, lines = "time,a,b\n";
  for (int k = 0; k < 60; ++k) {
    counted += std::to_string(k) + "," + std::to_string(k * k) + "\n";                  // digits become more
    ratios += std::to_string(k) + (k % 4 ? "." + std::to_string(k % 4) : "") + " 5\n";  // as many digits as needed
    lines += (k == 0 ? "0" : std::to_string(k) + ".25") + ",1,2\n";                     // with a header: the file begins at its beginning
  }
  for (const std::string& text : {counted, ratios, lines, std::string("7\n8\n9\n10\n11\n"), std::string("1,2\n3,4\n"),
                                  std::string("999.9,1\n1000.0,1\n1000.1,1\n1000.2,1\n1000.3,1\n1000.4,1\n1000.5,1\n1000.6,1\n1000.7,1\n"
                                              "1000.8,1\n1000.9,1\n1001.0,1\n")})
    EXPECT_EQ(cut_in(text), 0u) << text.substr(0, 40);
  // A gap after the first record is no cut.
  EXPECT_EQ(cut_in(row(-5000) + rows(1, 60)), 0u);
}

TEST_F(CutLine, AfterAHeaderOnlyMissingFieldsCount) {
  const std::string header = "t,p,q,r,x,y,z\n";
  EXPECT_EQ(cut_in(header + "0.1,-0.050,-9.800\n" + rows(1, 20)), 2u);
  EXPECT_EQ(cut_in(header + "8800.000" + row(0).substr(10) + rows(1, 20)), 0u);
  EXPECT_EQ(inspect_delimited(made(header + "0.1,-0.050,-9.800\n" + rows(1, 20))).names.size(), 7u);
}

TEST_F(CutLine, ACutOfAnImuLogIsCounted) {
  const auto read = [&](const std::string& text, core::Tally& tally) {
    ImuFile f;
    f.file = made(text);
    f.time = {core::TimeScale::gps_week, 2317, ""};
    f.kind = ImuKind::rates;
    f.angle_unit = AngleUnit::rad;
    f.acceleration_unit = AccelerationUnit::mps2;
    f.columns = {"1", "", "2", "3", "4", "5", "6", "7"};
    return read_imu(Survey{}, f, tally);
  };
  core::Tally whole, cut;
  const core::ImuData all = read(rows(0, 200), whole), without = read(row(0).substr(4) + rows(1, 200), cut);
  EXPECT_EQ(whole.of("IMU records cut off at the beginning of a file, left out"), 0u);
  EXPECT_EQ(cut.of("IMU records cut off at the beginning of a file, left out"), 1u);
  EXPECT_EQ(without.size() + 1, all.size());
  EXPECT_EQ(without.time.back(), all.time.back());
  EXPECT_EQ(cut.of("IMU gaps"), 0u);
}

}  // namespace
}  // namespace swath::io
