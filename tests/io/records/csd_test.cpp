// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/csd.h"

#include <Eigen/Geometry>
#include <cmath>

#include "core/error.h"
#include "io/survey/calibration_file.h"
#include "io/survey/survey.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

/// A CSD file with `n` pulses; longitudes lie below -2 pi, as the vendor's can.
std::string made_csd(int n) {
  std::string out(2048, '\0');
  auto* b = reinterpret_cast<unsigned char*>(out.data());
  std::memcpy(b, "CSD\0Optech Incorporated", 23);
  std::memcpy(b + 68, "DASHMap", 7);
  store<std::uint16_t>(b + 104, 2048);
  store<std::uint16_t>(b + 106, 1660);
  store<std::uint32_t>(b + 124, static_cast<std::uint32_t>(n));
  for (int i = 0; i < 6; ++i) store(b + 1154 + 8 * i, 0.01 * (i + 1));
  store(b + 1202, 21.5);
  store(b + 1210, 950.0);
  for (int i = 0; i < n; ++i) {
    unsigned char p[69] = {};
    store(p, 100.0 + 0.25 * i);
    p[8] = static_cast<unsigned char>(i % 5);
    for (int k = 0; k < 4; ++k) store(p + 9 + 4 * k, 500.0f + static_cast<float>(k));
    for (int k = 0; k < 4; ++k) store(p + 25 + 2 * k, static_cast<std::uint16_t>(10 * k));
    store(p + 33, 0.125f);
    store(p + 37, 0.25f);
    store(p + 41, 0.5f);
    store(p + 45, 0.75f);
    store(p + 49, 0.6);
    store(p + 57, -7.5);
    store(p + 65, 1000.5f);
    out.append(reinterpret_cast<const char*>(p), 69);
  }
  return out;
}

class Csd : public ::testing::Test {
 protected:
  std::filesystem::path made(const std::string& bytes) {
    test::write_bytes(folder_ / "a.csd", bytes);
    return folder_ / "a.csd";
  }
  test::TemporaryFolder folder_;
};

TEST_F(Csd, HeaderAndPulses) {
  CsdReader file(made(made_csd(7)));
  EXPECT_EQ(file.pulses(), 7u);
  EXPECT_EQ(file.header().vendor, "Optech Incorporated");
  EXPECT_EQ(file.header().gps_week, 1660);
  EXPECT_DOUBLE_EQ(calibration_of(file.header()).roll.value, 0.05);
  EXPECT_DOUBLE_EQ(calibration_of(file.header()).heading.value, 0.09);
  EXPECT_EQ(file.header().temperature, 21.5);
  EXPECT_EQ(file.header().pressure, 950.0);
  std::vector<CsdPulse> p;
  file.read(4, 2, p);
  EXPECT_EQ(p[0].return_count, 4);
  EXPECT_EQ(p[0].range[3], 503.0f);
  EXPECT_EQ(p[0].intensity[2], 20);
  EXPECT_EQ(p[1].time, 101.25);
  EXPECT_NEAR(p[1].longitude, -7.5 + 2 * core::pi, 1e-15);
}

TEST_F(Csd, PosesAreThinnedAndChecked) {
  core::Tally tally;
  CsdReader file(made(made_csd(7)));
  EXPECT_EQ(read_csd_trajectory(file, core::Seconds(0), tally).size(), 7u);
  EXPECT_EQ(read_csd_trajectory(file, core::Seconds(0.5), tally).time, (std::vector<double>{100, 100.5, 101, 101.5}));
  EXPECT_EQ(read_csd_trajectory(file, core::Seconds(60), tally).time, (std::vector<double>{100, 101.5}));
  std::string bad = made_csd(7);
  store(reinterpret_cast<unsigned char*>(bad.data()) + 2048 + 3 * 69, 100.0);
  CsdReader back(made(bad));
  try {
    read_csd_trajectory(back, core::Seconds(0), tally);
    FAIL();
  } catch (const core::Error& e) {
    EXPECT_NE(e.where().find("record 3"), std::string::npos);
  }
  bad = made_csd(7);
  store(reinterpret_cast<unsigned char*>(bad.data()) + 2048 + 3 * 69 + 37, std::nanf(""));
  CsdReader holes(made(bad));
  EXPECT_THROW(read_csd_trajectory(holes, core::Seconds(0), tally), core::Error);
}

TEST_F(Csd, ABoresightThatIsNoAngleIsRefused) {
  core::Calibration calibration;
  core::SensorSigma sigma;
  load_calibration(made(made_csd(3)), calibration, sigma);
  EXPECT_DOUBLE_EQ(calibration.heading.value, 0.09);
  for (const double wrong : {4e37, std::nan("")}) {
    std::string bytes = made_csd(3);
    store(reinterpret_cast<unsigned char*>(bytes.data()) + 1154 + 8, wrong);
    EXPECT_THROW(load_calibration(made(bytes), calibration, sigma), core::Error) << wrong;
  }
}

TEST_F(Csd, TruncatedAndForeignFilesAreErrors) {
  const std::string whole = made_csd(3);
  for (size_t n = 0; n < whole.size(); n += n < 2040 ? 97 : 1) EXPECT_THROW(CsdReader(made(whole.substr(0, n))), core::Error) << n;
  EXPECT_THROW(CsdReader(made(std::string(4000, 'x'))), core::Error);
  std::string many = whole;
  many[2048 + 8] = 5;
  CsdReader file(made(many));
  std::vector<CsdPulse> p;
  EXPECT_THROW(file.read(0, 3, p), core::Error);
}

/// Rotation of vectors with x right, y forward, z up: R3(heading) R1(-pitch) R2(-roll) as the vendor has it; clockwise heading.
Eigen::Matrix3d vendor_matrix(double roll, double pitch, double heading) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(-heading, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitX()) * AngleAxisd(roll, Vector3d::UnitY()))
      .toRotationMatrix();
}

TEST(CsdReference, TheFirstPointOfTheSample) {
  SWATH_SHARED_OR_SKIP(path, "data/optech_csd/sample.csd");
  CsdReader file(path);
  ASSERT_EQ(file.pulses(), 1000u);
  EXPECT_NEAR(file.header().misalignment[0], 0.028, 5e-4);
  EXPECT_NEAR(file.header().imu_offset[1], -0.00211, 5e-6);
  std::vector<CsdPulse> p;
  file.read(0, 1000, p);
  size_t returns = 0;
  for (const CsdPulse& one : p) {
    returns += static_cast<size_t>(one.return_count);
    EXPECT_TRUE(std::abs(one.longitude) < core::pi && one.range[0] > 700 && one.range[0] < 1200);
  }
  EXPECT_EQ(returns, 1000u);
  EXPECT_NEAR(p[0].time, 575644.74484563898, 1e-9);
  EXPECT_NEAR(p[0].range[0], 827.3567, 1e-4);
  EXPECT_NEAR(core::to_degrees(p[0].scan_angle), -14.555, 1e-3);
  // The published point of this pulse, by the same local linearisation: the boresight is read with the right signs and order.
  const core::Calibration c = calibration_of(file.header());
  const double a = p[0].scan_angle;
  const Eigen::Vector3d enu = vendor_matrix(p[0].roll, p[0].pitch, p[0].heading) *
                              vendor_matrix(c.roll.value, c.pitch.value, c.heading.value) *
                              (p[0].range[0] * Eigen::Vector3d(std::sin(a), 0, -std::cos(a)));
  const double semi_major = 6378137.0, e2 = 0.00669437999014, s = std::sin(p[0].latitude);
  const double N = semi_major / std::sqrt(1 - e2 * s * s), M = N * (1 - e2) / (1 - e2 * s * s);
  EXPECT_NEAR(core::to_degrees(p[0].longitude + enu.x() / (N * std::cos(p[0].latitude))), -82.554028877408555, 1e-9);
  EXPECT_NEAR(core::to_degrees(p[0].latitude + enu.y() / M), 36.534611447321907, 1e-9);
  EXPECT_NEAR(p[0].height + enu.z(), 344.80889224602356, 1e-3);
  core::Tally tally;
  EXPECT_EQ(read_csd_trajectory(file, core::Seconds(0), tally).size(), 1000u);
  EXPECT_TRUE(tally.empty());
}

}  // namespace
}  // namespace swath::io
