// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/pos_writer.h"

#include "core/time.h"
#include "io/gnss/rtklib_pos.h"
#include "tests/world/support.h"

namespace swath::io {
namespace {

// Digits of the form: 0.1 mm, 1 us (GPS seconds in a double resolve 0.24 us), 0.1 mm of the square root of a covariance near 1e-4 m^2.
constexpr double position_digit = 0.5e-4 + 1e-9, time_digit = 1e-6, covariance_digit = 2 * 0.02 * 0.5e-4 + 1e-8;

TEST(PosWriter, ReadsBackAsWritten) {
  const test::TemporaryFolder folder;
  core::GnssData g;
  Eigen::Matrix3d c;
  c << 4e-4, -1e-4, 0.5e-4, -1e-4, 3e-4, 1.5e-4, 0.5e-4, 1.5e-4, 2e-4;
  const core::FixQuality all[] = {core::FixQuality::fixed, core::FixQuality::float_ambiguity, core::FixQuality::differential,
                                  core::FixQuality::sbas,  core::FixQuality::single,          core::FixQuality::ppp};
  for (size_t i = 0; i < 6; ++i) {
    g.time.push_back(core::from_week(1316, 604799.0) + 0.2 * static_cast<double>(i + 1) - 1e-7);
    g.position.emplace_back(-3976219.12341 + static_cast<double>(i), 3382371.6, -3652511.98764);
    g.covariance.push_back(c);
    g.quality.push_back(all[i]);
    g.satellites.push_back(static_cast<std::uint8_t>(7 + i));
  }
  write_pos(folder / "a.pos", g, {"one remark", "another"});
  EXPECT_TRUE(test::read_bytes(folder / "a.pos").starts_with("% one remark\n% another\n%"));
  core::Tally tally;
  const core::GnssData back = read_pos(folder / "a.pos", {}, 0.0, tally);
  ASSERT_EQ(back.size(), g.size());
  for (size_t i = 0; i < g.size(); ++i) {
    EXPECT_NEAR(back.time[i], g.time[i], time_digit);
    EXPECT_LT((back.position[i] - g.position[i]).cwiseAbs().maxCoeff(), position_digit);
    EXPECT_LT((back.covariance[i] - c).cwiseAbs().maxCoeff(), covariance_digit);
    EXPECT_EQ(back.quality[i], g.quality[i]);
    EXPECT_EQ(back.satellites[i], g.satellites[i]);
  }
  EXPECT_NE(test::read_bytes(folder / "a.pos").find("\n1317      0.000000 "), std::string::npos) << "rounds up into the next week";
}

}  // namespace
}  // namespace swath::io
