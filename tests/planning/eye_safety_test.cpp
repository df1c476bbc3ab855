// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/eye_safety.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::planning {
namespace {

/// Values of IEC 60825-1:2014, table A.1, for one pulse of nanoseconds: 2 mJ/m2 in the visible, 20 mJ/m2 at 1064 nm, 10 kJ/m2 at 1550 nm.
TEST(EyeSafety, LimitsOfOnePulse) {
  EXPECT_DOUBLE_EQ(*permissible_exposure(532e-9, 5e-9), 2e-3);
  EXPECT_DOUBLE_EQ(*permissible_exposure(1064e-9, 5e-9), 2e-2);
  EXPECT_DOUBLE_EQ(*permissible_exposure(1550e-9, 5e-9), 1e4);
  EXPECT_NEAR(*permissible_exposure(905e-9, 5e-9), 2e-3 * std::pow(10, 0.002 * 205), 1e-9);
  EXPECT_NEAR(*permissible_exposure(532e-9, 0.25), 18 * std::pow(0.25, 0.75), 1e-9);  // 6.4 J/m2: the aversion response
  EXPECT_FALSE(permissible_exposure(355e-9, 5e-9));
  EXPECT_FALSE(permissible_exposure(10.6e-6, 5e-9));
}

/// A beam much wider than the pupil spreads its energy evenly over it at the axis: 4 / pi E / (angle h)^2 to 1/e is the limit.
TEST(EyeSafety, TheHeightIsWhereTheAxisMeetsTheLimit) {
  LaserPulses l;
  l.energy = 100e-6;
  l.wavelength = 1064e-9;
  l.divergence = 0.3e-3;
  l.prf = 0.0;
  const EyeSafety e = *eye_safety(l);
  EXPECT_EQ(e.pulses, 1.0);
  const double axis = 4 * l.energy / (M_PI * std::pow(l.divergence / std::sqrt(2.0) * e.height, 2));
  EXPECT_NEAR(axis, 2e-2, 0.01 * 2e-2);  // the pupil is a twelfth of the beam
  EXPECT_NEAR(e.with_binoculars / e.height, 50.0 / 7.0, 0.02);
}

TEST(EyeSafety, MorePulsesWantMoreHeight) {
  LaserPulses l{50e-6, 1064e-9, 0.3e-3, 500e3, 30.0};
  const EyeSafety one = *eye_safety({50e-6, 1064e-9, 0.3e-3, 10e3, 300.0}), many = *eye_safety(l);
  EXPECT_GT(many.pulses, 4.0);
  EXPECT_GT(many.height, one.height);
  l.energy = 200e-6;
  EXPECT_NEAR(eye_safety(l)->height / many.height, 2.0, 0.05);  // the root of the energy
}

/// What 1550 nm is used for: the same pulse is safe at the aircraft.
TEST(EyeSafety, BeyondTheRetina) {
  const EyeSafety near_infrared = *eye_safety({100e-6, 1064e-9, 0.3e-3, 100e3, 70.0}),
                  far = *eye_safety({100e-6, 1550e-9, 0.3e-3, 100e3, 70.0});
  EXPECT_GT(near_infrared.height, 100.0);
  EXPECT_EQ(far.height, 0.0);
}

}  // namespace
}  // namespace swath::planning
