// SPDX-License-Identifier: GPL-3.0-or-later
// From which height a laser scanner is safe to look into: maximum permissible exposure (MPE) of the eye by IEC 60825-1:2014, annex A, and
// the distance at which a pulse falls below it. Assumptions: one small source (below 1.5 mrad), pulses of 10 ps to 5 us (from 1 ns beyond
// 1400 nm), a beam of Gaussian profile that leaves the scanner as a point, no loss in the air, a mirror that turns. It does not replace the
// manufacturer's nominal ocular hazard distance.
#pragma once

#include <optional>

namespace swath::planning {

struct LaserPulses {
  double energy = 0.0;          ///< J of one pulse
  double wavelength = 1064e-9;  ///< m
  double divergence = 0.0;      ///< full angle (1/e2), rad
  double prf = 0.0;             ///< pulses per second
  double angular_speed = 0.0;   ///< of the beam, slowest mean over a scan, rad/s
};

/// MPE of the cornea for one exposure of `seconds`, J/m2; nothing outside 400 to 2600 nm.
std::optional<double> permissible_exposure(double wavelength, double seconds);

struct EyeSafety {
  double exposure = 0.0;         ///< permissible exposure of one pulse, J/m2, by the stricter of both criteria at the height below
  double pulses = 0.0;           ///< that meet an eye in one passage of the beam at that height
  double height = 0.0;           ///< m: below it a naked eye may be harmed
  double with_binoculars = 0.0;  ///< m: the same behind optics of 50 mm
};
/// Nothing where the wavelength has no limit here. Energy and divergence above 0.
std::optional<EyeSafety> eye_safety(const LaserPulses& laser);

}  // namespace swath::planning
