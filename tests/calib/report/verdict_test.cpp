// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/report/verdict.h"

#include <gtest/gtest.h>

#include <limits>

#include "core/config/units.h"
#include "tests/calib/report/made_report.h"
#include "tests/calib/report/part_of_page.h"

namespace swath::calib {
namespace {

constexpr double arc_second = core::degree / 3600.0;

calib::Adjustment boresight_only(double roll, double pitch, double heading) {
  calib::Adjustment a;
  const double sigmas[] = {roll, pitch, heading};
  for (int k = 0; k < estimated_count; ++k) {
    calib::Estimate& e = a.estimates[static_cast<size_t>(k)];
    e.parameter = parameter_at(k);
    e.estimated = k < 3;
    if (k < 3) e.sigma = sigmas[k] * arc_second;
  }
  return a;
}

TEST(CalibrationVerdict, TellsEachSigmaInOneSentence) {
  const CalibrationVerdict v = verdict_of(boresight_only(1.2, 1.9, 3.4));
  EXPECT_TRUE(v.calibrated);
  EXPECT_EQ(v.tone, report::Tone::good);
  EXPECT_EQ(v.text, "Calibrated: boresight roll, pitch and heading are known to 1.2, 1.9 and 3.4 arcsec (one sigma).");

  calib::Adjustment a = boresight_only(1.2, 1.9, 3.4);
  a.estimates[calib::boresight_pitch].estimated = false;
  a.estimates[calib::range_offset].estimated = true;
  a.estimates[calib::range_offset].sigma = 0.0081;
  a.estimates[calib::lever_right].estimated = a.estimates[calib::lever_down].estimated = true;
  a.estimates[calib::lever_right].sigma = 0.01;
  a.estimates[calib::lever_down].sigma = 0.02;
  EXPECT_EQ(
      verdict_of(a).text,
      "Calibrated: boresight roll and heading are known to 1.2 and 3.4 arcsec (one sigma), the range offset to 8.1 mm, the lever arm right "
      "and down to 10.0 and 20.0 mm.");
  for (int k = 0; k < 3; ++k) a.estimates[static_cast<size_t>(k)].estimated = false;
  EXPECT_TRUE(verdict_of(a).text.starts_with("Calibrated: the range offset is known to 8.1 mm (one sigma), ")) << verdict_of(a).text;
}

TEST(CalibrationVerdict, ARefusedAngleIsNoCalibration) {
  calib::Adjustment a = boresight_only(1.2, 90.0, 3.4);
  a.findings.push_back({"pitch is not determined: only one line direction",
                        "fly one of the lines once more in the opposite direction",
                        {calib::boresight_pitch},
                        true});
  const CalibrationVerdict v = verdict_of(a);
  EXPECT_FALSE(v.calibrated);
  EXPECT_EQ(v.tone, report::Tone::bad);
  EXPECT_EQ(v.text,
            "Not calibrated: pitch is not determined: only one line direction. Fly one of the lines once more in the opposite direction.");
  EXPECT_TRUE(is_delivered(a, calib::boresight_roll));
  EXPECT_FALSE(is_delivered(a, calib::boresight_pitch));
}

TEST(CalibrationVerdict, ARefusalWithoutParametersIsOfAll) {
  calib::Adjustment a = boresight_only(1, 1, 1);
  a.findings.push_back({"no plane is seen by two lines", "fly overlapping lines over buildings", {}, true});
  const CalibrationVerdict v = verdict_of(a);
  EXPECT_FALSE(v.calibrated);
  EXPECT_TRUE(holds(v.text, "no plane is seen by two lines. Fly overlapping lines over buildings.")) << v.text;
}

TEST(CalibrationVerdict, NothingEstimatedOrNoSigmaIsNoCalibration) {
  EXPECT_EQ(verdict_of(calib::Adjustment{}).text, "Not calibrated: no parameter was estimated.");
  const CalibrationVerdict v = verdict_of(boresight_only(1, std::numeric_limits<double>::quiet_NaN(), 1));
  EXPECT_FALSE(v.calibrated);
  EXPECT_EQ(v.text, "Not calibrated: the boresight came out without a sigma.");
}

TEST(CalibrationVerdict, OtherParametersRefusedAndPointsThatDisagreeAreSaid) {
  const CalibrationVerdict v = verdict_of(made_report(true).adjustment);
  EXPECT_TRUE(v.calibrated);
  EXPECT_EQ(v.tone, report::Tone::caution);
  EXPECT_TRUE(holds(v.text, "not determined, and left at its start value: the range scale")) << v.text;
  EXPECT_FALSE(holds(v.text, "range scale to")) << v.text;
  EXPECT_TRUE(holds(v.text, "1 of 8 surveyed points disagree with the flight")) << v.text;
  EXPECT_TRUE(holds(v.text, "Read the warnings below.")) << v.text;
}

TEST(CalibrationVerdict, Joined) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"a"}), "a");
  EXPECT_EQ(joined({"a", "b", "c"}), "a, b and c");
}

}  // namespace
}  // namespace swath::calib
