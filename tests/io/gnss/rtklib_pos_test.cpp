// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/rtklib_pos.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double place = 3e-7;  // s
const std::string tail = "   1  21   0.0300   0.0200   0.0500   0.0100  -0.0150   0.0200   0.10   5.1";
const std::string sds = " Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio";

class PosFiles : public ::testing::Test {
 protected:
  core::GnssData read(const std::string& text, GnssFile f = {}, double latency = 0) {
    test::write_bytes(folder_ / "a.pos", text);
    return read_pos(folder_ / "a.pos", f, latency, tally_);
  }
  std::string refusal(const std::string& text, GnssFile f = {}) {
    try {
      read(text, f);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "was read";
  }
  test::TemporaryFolder folder_;
  core::Tally tally_;
  const Vector3d here_ = core::ecef_of({core::degrees(40.5).value, core::degrees(-105.25).value, 1600});
  const double t_ = core::from_week(2374, 243258.5);  // 2025-07-08 19:34:18.5 GPST
};

TEST_F(PosFiles, LatitudeLongitudeHeightInEveryTimeForm) {
  const std::string place_text = "  40.500000000 -105.250000000  1600.0000";
  const std::string intro = "% program   : RTKLIB\n% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix,2:float)\n";
  const std::string columns = " latitude(deg) longitude(deg)  height(m)  " + sds + "\n";
  for (const auto& [scale, when] : {std::pair{"GPST", "2025/07/08 19:34:18.500"},
                                    {"UTC ", "2025/07/08 19:34:00.500"},
                                    {"JST ", "2025/07/09 04:34:00.500"},
                                    {"GPST", "2374 243258.500"},
                                    {"UTC ", "2374 243240.500"}}) {
    const core::GnssData g = read(intro + "%  " + scale + columns + when + place_text + tail + "\n", {}, 0.25);
    ASSERT_EQ(g.size(), 1u) << when;
    EXPECT_NEAR(g.time[0], t_ + 0.25, place) << scale << when;
    EXPECT_NEAR((g.position[0] - here_).norm(), 0, 1e-6);
    EXPECT_EQ(g.quality[0], core::FixQuality::fixed);
    EXPECT_EQ(g.satellites[0], 21);
    Matrix3d R = core::ecef_R_ned(core::degrees(40.5).value, core::degrees(-105.25).value), neu;
    R.col(2) *= -1;
    neu << 9, 1, 4, 1, 4, -2.25, 4, -2.25, 25;  // squares with the roots' signs
    EXPECT_NEAR((R.transpose() * g.covariance[0] * R - 1e-4 * neu).norm(), 0, 1e-12);
    EXPECT_FALSE(g.has_velocity());
  }
}

TEST_F(PosFiles, SeparatorsDegreesMinutesSecondsAndNoHeader) {
  core::GnssData g = read(
      "%  GPST,latitude(deg),longitude(deg),height(m),Q,ns,sdn(m),sde(m),sdu(m)\n2025/07/08 19:34:18.500,40.5,-105.25,1600,2,9,1,1,1\n");
  EXPECT_NEAR((g.position[0] - here_).norm(), 0, 1e-6);
  EXPECT_EQ(g.quality[0], core::FixQuality::float_ambiguity);
  g = read("%  GPST  latitude(d'\") longitude(d'\") height(m) " + sds +
           "\n2025/07/08 19:34:18.500\t40 30 00.00000\t-105 15 00.00000\t1600.0" + tail + "\n");
  EXPECT_NEAR((g.position[0] - here_).norm(), 0, 1e-6);
  g = read("%  GPST  latitude(d'\") longitude(d'\") height(m) " + sds + "\n2025/07/08 19:34:18.500 -0 30 00.0 -0 15 00.0 10.0" + tail +
           "\n");
  const core::Geodetic south = core::geodetic_of(g.position[0]);
  EXPECT_NEAR(core::to_degrees(south.latitude), -0.5, 1e-9);
  EXPECT_NEAR(core::to_degrees(south.longitude), -0.25, 1e-9);
  g = read("2025/07/08 19:34:18.500 40.5 -105.25 1600" + tail + "\n");
  EXPECT_NEAR(g.time[0], t_, place);
  EXPECT_NEAR((g.position[0] - here_).norm(), 0, 1e-6);
}

TEST_F(PosFiles, EcefAndBaselines) {
  const std::string xyz = core::format_number(here_.x()) + " " + core::format_number(here_.y()) + " " + core::format_number(here_.z());
  core::GnssData g = read(
      "% (x/y/z-ecef=WGS84,Q=1:fix)\n%  GPST x-ecef(m) y-ecef(m) z-ecef(m) Q ns sdx(m) sdy(m) sdz(m) sdxy(m) sdyz(m) sdzx(m) age(s) ratio "
      "vx(m/s) vy(m/s) vz(m/s) sdvx sdvy sdvz sdvxy sdvyz sdvzx\n2374 243258.5 " +
      xyz + " 1 9 0.03 0.02 0.05 0.01 -0.015 0.02 0 0 1 2 3 0.1 0.1 0.1 0 0 0\n");
  EXPECT_EQ(g.position[0], here_);
  Matrix3d m;
  m << 9, 1, 4, 1, 4, -2.25, 4, -2.25, 25;
  EXPECT_NEAR((g.covariance[0] - 1e-4 * m).norm(), 0, 1e-15);
  EXPECT_EQ(g.velocity[0], Vector3d(1, 2, 3));
  EXPECT_NEAR(g.velocity_covariance[0](1, 1), 0.01, 1e-15);

  const std::string enu =
      "%  GPST e-baseline(m) n-baseline(m) u-baseline(m) Q ns sde(m) sdn(m) sdu(m) sden(m) sdnu(m) sdue(m) age(s) ratio\n"
      "2374 243258.5 100 200 -3 1 9 0.02 0.03 0.05 0.01 0.02 -0.015 0 0\n";
  Matrix3d R = core::ecef_R_ned(core::degrees(40.5).value, core::degrees(-105.25).value);
  R.col(2) *= -1;
  const Vector3d there = here_ + R * Vector3d(200, 100, -3);
  for (const char* base : {"% ref pos   : 40.500000000 -105.250000000 1600.0000\n", "% ref pos   : 40 30 00.0 -105 15 00.0 1600.0\n"}) {
    g = read(std::string("% (e/n/u-baseline=WGS84,Q=1:fix)\n") + base + enu);
    EXPECT_NEAR((g.position[0] - there).norm(), 0, 1e-6);
    EXPECT_NEAR((R.transpose() * g.covariance[0] * R - 1e-4 * m).norm(), 0, 1e-12);
  }
  EXPECT_NE(refusal(enu).find("without the position of their base"), std::string::npos);
  GnssFile f;
  f.base = {core::Metres(here_.x()), core::Metres(here_.y()), core::Metres(here_.z())};
  EXPECT_NEAR((read(enu, f).position[0] - there).norm(), 0, 1e-9);
}

TEST_F(PosFiles, VelocitiesNorthEastUp) {
  const core::GnssData g = read("%  GPST latitude(deg) longitude(deg) height(m) " + sds +
                                " vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu sdvne sdveu sdvun\n"
                                "2374 243258.5 40.5 -105.25 1600" +
                                tail + " 4 5 6 0.1 0.2 0.3 0 0 0\n");
  ASSERT_TRUE(g.has_velocity());
  const Matrix3d R = core::ecef_R_ned(core::degrees(40.5).value, core::degrees(-105.25).value);
  EXPECT_NEAR((R.transpose() * g.velocity[0] - Vector3d(4, 5, -6)).norm(), 0, 1e-12);
  EXPECT_NEAR((R.transpose() * g.velocity_covariance[0] * R)(2, 2), 0.09, 1e-12);
}

TEST_F(PosFiles, HeightsAboveTheGeoidAndOtherDatumsAreRefused) {
  const std::string row = "%  GPST latitude(deg) longitude(deg) height(m) " + sds + "\n2374 243258.5 40.5 -105.25 1600" + tail + "\n";
  EXPECT_NE(refusal("% (lat/lon/height=WGS84/geodetic,Q=1:fix)\n" + row).find("above the geoid"), std::string::npos);
  EXPECT_NE(refusal("% (lat/lon/height=Tokyo/ellipsoidal,Q=1:fix)\n" + row).find("Tokyo"), std::string::npos);
  GnssFile f;
  f.geoid_height = true;
  EXPECT_NE(refusal(row, f).find("above the geoid"), std::string::npos);
}

TEST_F(PosFiles, JunkIsCountedAndTooMuchIsRefused) {
  std::string text = "%  GPST latitude(deg) longitude(deg) height(m) " + sds + "\n";
  for (int i = 0; i < 100; ++i)
    text += "2374 " + std::to_string(243258 + i) + " 40.5 -105.25 1600" + (i == 7 ? "   0  0 0 0 0 0 0 0 0 0" : tail) + "\n";
  std::string binary = "\x01\x02 junk \xff";
  binary += '\0';
  const std::string far = "5830/07/08 19:34:18.500 40.5 -105.25 1600" + tail + "\n";
  const core::GnssData g = read(text + far + binary + "\n2374 243400 40.5 -105.\n");
  EXPECT_EQ(g.size(), 99u);
  EXPECT_EQ(tally_.of("RTKLIB lines that are no solution, left out"), 3u);
  EXPECT_EQ(tally_.of("RTKLIB lines of epochs without a solution, left out"), 1u);
  EXPECT_NE(refusal("a b c d e f g\na b c d e f g\n").find("2 of 2 lines are no solution"), std::string::npos);
  EXPECT_NE(refusal("%  GPST latitude(deg) longitude(deg) height(m) Q ns\n").find("no position"), std::string::npos);
  EXPECT_NE(refusal("2374 243258 400.5 -105.25 1600" + tail + "\n").find("a.pos:1"), std::string::npos);
  EXPECT_NE(refusal(text + "2374 243000 40.5 -105.25 1600" + tail + "\n").find("a.pos:102: time goes back"), std::string::npos);
}

TEST_F(PosFiles, EveryTruncationIsReadOrRefused) {
  std::string text =
      "% (lat/lon/height=WGS84/ellipsoidal,Q=1:fix)\n% ref pos   : 40.5 -105.2 1600.0\n%  GPST latitude(deg) longitude(deg) height(m) ";
  text += sds + "\n2374 243258 40.5 -105.25 1600" + tail + "\n";
  const size_t first = text.size();
  text += "2374 243259 40.5 -105.25 1600" + tail + "\n";
  for (size_t n = 0; n <= text.size(); ++n) {
    try {
      EXPECT_GE(read(text.substr(0, n)).size(), 1u);
    } catch (const core::Error& e) {
      EXPECT_LT(n, first) << e.text();
    }
  }
}

TEST(PosReference, ADrive) {
  SWATH_SHARED_OR_SKIP(file, "data/car_imu_rtk/drive_0708/gnss_1934_sf.pos");
  EXPECT_TRUE(looks_like_pos(file));
  core::Tally tally;
  const core::GnssData g = read_pos(file, {}, 0, tally);
  ASSERT_EQ(g.size(), 2197u);
  EXPECT_EQ(tally.of("GNSS fixes: fixed"), 2189u);
  EXPECT_NEAR(g.time[0], core::from_week(2374, 243258.499), place);
  EXPECT_NEAR(g.time.back() - g.time.front(), 549, place);
  // The velocities are those of the positions: over half seconds of a drive within some tenths of m/s.
  double squares = 0;
  for (size_t i = 1; i + 1 < g.size(); ++i)
    squares += ((g.position[i + 1] - g.position[i - 1]) / (g.time[i + 1] - g.time[i - 1]) - g.velocity[i]).squaredNorm();
  EXPECT_LT(std::sqrt(squares / static_cast<double>(g.size())), 0.2);
}

}  // namespace
}  // namespace swath::io
