// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/gnss_file.h"

#include <cmath>

#include "core/error.h"
#include "core/geo/geodesy.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double millimetre = 1e-3;

GnssFile text_file(const std::filesystem::path& path) {
  GnssFile f;
  f.file = path;
  f.time = {core::TimeScale::gps_week, 2317, ""};
  f.columns.time = "t";
  f.columns.latitude = "lat";
  f.columns.longitude = "lon";
  f.columns.height = "h";
  return f;
}

class GnssFiles : public ::testing::Test {
 protected:
  GnssFile made(const std::string& rows, const std::string& header = "t,lat,lon,h,sn,se,su,vn,ve,vu,q,ns\n",
                const std::string& name = "gnss.csv") {
    test::write_bytes(folder_ / name, header + rows);
    return text_file(folder_ / name);
  }
  core::GnssData read(const GnssFile& f) { return read_gnss(survey_, f, tally_); }
  std::string refusal(const GnssFile& f) {
    try {
      read(f);
    } catch (const core::Error& e) {
      return e.text();
    }
    return "was read";
  }
  test::TemporaryFolder folder_;
  Survey survey_;
  core::Tally tally_;
};

TEST_F(GnssFiles, GeodeticWithSigmasAndVelocities) {
  GnssFile f = made("10,48,11,500,0.01,0.02,0.03,1,2,3,1,17\n11,48.1,11.1,501,0.01,0.02,0.03,1,2,3,2,9\n");
  f.columns.sigma_north = "sn";
  f.columns.sigma_east = "se";
  f.columns.sigma_up = "su";
  f.columns.v_north = "vn";
  f.columns.v_east = "ve";
  f.columns.v_up = "vu";
  f.columns.quality = "q";
  f.columns.satellites = "ns";
  survey_.antenna.latency = core::Seconds(0.02);
  f.time.offset = core::Seconds(1);
  const core::GnssData g = read(f);
  ASSERT_EQ(g.size(), 2u);
  EXPECT_NEAR(g.time[0], core::from_week(2317, 11.02), 3e-7);
  EXPECT_EQ(g.quality[1], core::FixQuality::float_ambiguity);
  EXPECT_EQ(g.satellites[0], 17);
  const double lat = core::degrees(48).value, lon = core::degrees(11).value;
  EXPECT_NEAR((g.position[0] - core::ecef_of({lat, lon, 500})).norm(), 0, 1e-6);
  const Matrix3d R = core::ecef_R_ned(lat, lon);
  EXPECT_NEAR((R.transpose() * g.covariance[0] * R - Matrix3d(Vector3d(1e-4, 4e-4, 9e-4).asDiagonal())).norm(), 0, 1e-12);
  EXPECT_NEAR((R.transpose() * g.velocity[0] - Vector3d(1, 2, -3)).norm(), 0, 1e-12);
}

TEST_F(GnssFiles, EcefWithFullCovarianceAndWeeks) {
  const Vector3d p = core::ecef_of({0.8, 0.2, 300});
  const std::string xyz = core::format_number(p.x()) + "," + core::format_number(p.y()) + "," + core::format_number(p.z());
  GnssFile f = made("2317,604799.5," + xyz + ",4,1,0.5,3,0.25,2\n2318,0.5," + xyz + ",4,1,0.5,3,0.25,2\n", "w,t,x,y,z,a,b,c,d,e,f\n");
  f.columns = {};
  f.columns.time = "t";
  f.columns.week = "w";
  f.columns.x = "x";
  f.columns.y = "y";
  f.columns.z = "z";
  f.columns.cov_xx = "a";
  f.columns.cov_xy = "b";
  f.columns.cov_xz = "c";
  f.columns.cov_yy = "d";
  f.columns.cov_yz = "e";
  f.columns.cov_zz = "f";
  f.time.week.reset();
  const core::GnssData g = read(f);
  EXPECT_EQ(g.time[1] - g.time[0], 1.0);
  EXPECT_EQ(g.position[0], p);
  Matrix3d m;
  m << 4, 1, 0.5, 1, 3, 0.25, 0.5, 0.25, 2;
  EXPECT_EQ(g.covariance[0], m);
}

TEST_F(GnssFiles, UnitsThatCannotBe) {
  GnssFile f = made("10,48,11,500\n", "t,lat,lon,h\n");
  f.angle_unit = AngleUnit::rad;
  EXPECT_NE(refusal(f).find("gnss.csv:2: latitude 48, longitude 11 are no rad"), std::string::npos) << refusal(f);
  f = made("10,0.8,0.2,500\n11,0.8,0.2,500\n", "t,lat,lon,h\n");
  EXPECT_EQ(read(f).size(), 2u);
  EXPECT_EQ(tally_.of("GNSS files whose latitudes and longitudes would all be radians: radians stated as degrees?"), 1u);
  f.angle_unit = AngleUnit::unstated;
  EXPECT_NE(refusal(f).find("angle_unit"), std::string::npos);
  f = made("10,48,11,500000\n", "t,lat,lon,h\n");
  EXPECT_NE(refusal(f).find("not near the ground"), std::string::npos);
}

// Counted down: -952 m is 450 m above land of 500 m.
TEST_F(GnssFiles, HeightsOfTheWrongSignAreRefused) {
  const std::string said = refusal(made("10,48,11,-952\n11,48,11,-953\n", "t,lat,lon,h\n"));
  EXPECT_NE(said.find("gnss.csv:2: the position lies below all land: height -952 m"), std::string::npos) << said;
  EXPECT_NE(said.find("may count down"), std::string::npos) << said;
  EXPECT_EQ(read(made("10,31.5,35.5,-412\n11,31.5,35.5,-412\n", "t,lat,lon,h\n")).size(), 2u);  // the Dead Sea
}

TEST_F(GnssFiles, DamagedRows) {
  std::string rows;
  for (int i = 0; i < 100; ++i)
    rows += std::to_string(604750 + i > 604799 ? i - 50 : 604750 + i) + (i == 20 ? ",nan" : ",48") + ",11,500\n";
  rows += "49,48,11,500\n";
  const core::GnssData g = read(made(rows, "t,lat,lon,h\n"));
  EXPECT_EQ(g.size(), 99u);  // over the end of the week
  EXPECT_EQ(g.time.back(), core::from_week(2318, 49));
  EXPECT_EQ(tally_.of("GNSS fixes with a value that is empty or not finite, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS fixes at a repeated time, left out"), 1u);
  EXPECT_EQ(tally_.of("GNSS gaps"), 1u);
  EXPECT_NE(refusal(made("10,48,11,500\n9,48,11,500\n", "t,lat,lon,h\n")).find("gnss.csv:3: time goes back"), std::string::npos);
  EXPECT_NE(refusal(made("10,48,x,500\n", "t,lat,lon,h\n")).find("gnss.csv:2"), std::string::npos);
}

TEST_F(GnssFiles, FilesAreJoined) {
  GnssFile a = made("10,48,11,500,1\n11,48,11,500,1\n", "t,lat,lon,h,v\n", "a.csv");
  for (std::string* c : {&a.columns.v_north, &a.columns.v_east, &a.columns.v_up}) *c = "v";
  const GnssFile b = made("20,48,11,500\n21,48,11,500\n", "t,lat,lon,h\n", "b.csv");
  survey_.gnss = {b, a};
  const core::GnssData g = read_gnss(survey_, tally_);
  ASSERT_EQ(g.size(), 4u);
  EXPECT_EQ(g.velocity.size(), 4u);
  EXPECT_TRUE(std::isnan(g.velocity[3].x()));
  EXPECT_NEAR(g.velocity[0].norm(), std::sqrt(3.0), 1e-12);
  survey_.gnss = {a, a};
  EXPECT_THROW(read_gnss(survey_, tally_), core::Error);
  survey_.gnss.clear();
  EXPECT_THROW(read_gnss(survey_, tally_), core::Error);
  survey_.gnss = {b};
  survey_.gnss[0].file = "b.dat";
  EXPECT_THROW(read_gnss(survey_, tally_), core::Error);
}

TEST(GnssReference, TextInBothForms) {
  SWATH_SHARED_OR_SKIP(file, "data/tiny_survey/gnss.csv");
  GnssFile f = text_file(file);
  f.columns = {};
  f.columns.time = "gps_sow_s";
  f.columns.satellites = "n_sat";
  GnssFile ecef = f;
  f.columns.latitude = "lat_deg";
  f.columns.longitude = "lon_deg";
  f.columns.height = "h_ell_m";
  f.columns.sigma_north = "sd_north_m";
  f.columns.sigma_east = "sd_east_m";
  f.columns.sigma_up = "sd_down_m";
  ecef.columns.x = "ecef_x_m";
  ecef.columns.y = "ecef_y_m";
  ecef.columns.z = "ecef_z_m";
  ecef.columns.cov_xx = "cov_xx_m2";
  ecef.columns.cov_xy = "cov_xy_m2";
  ecef.columns.cov_xz = "cov_xz_m2";
  ecef.columns.cov_yy = "cov_yy_m2";
  ecef.columns.cov_yz = "cov_yz_m2";
  ecef.columns.cov_zz = "cov_zz_m2";
  core::Tally tally;
  const core::GnssData a = read_gnss(Survey{}, f, tally), b = read_gnss(Survey{}, ecef, tally);
  ASSERT_EQ(a.size(), 156u);
  ASSERT_EQ(b.size(), a.size());
  EXPECT_EQ(b.covariance[0](0, 1), -1.94122273e-06);
  EXPECT_EQ(b.covariance[0](2, 2), 6.07877744e-04);
  EXPECT_EQ(tally.of("GNSS gaps"), 0u);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_NEAR((a.position[i] - b.position[i]).norm(), 0, millimetre);
    // The file's covariances are not turned as its sigmas are (the vertical is 11 deg off), but their sums agree: sigmas are written
    // with 0.1 mm, which is 0.7 % of a variance of 15 mm.
    EXPECT_NEAR(a.covariance[i].trace() / b.covariance[i].trace(), 1, 0.007);
  }
}

}  // namespace
}  // namespace swath::io
