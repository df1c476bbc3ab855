// SPDX-License-Identifier: GPL-3.0-or-later
// IEC 60825-1:2014, tables A.1 and A.6 (limits as in the ICNIRP guidelines of 2013): one pulse, and the mean over the pulses of one
// passage. C5 is 1: an eye on the ground meets fewer than 600 pulses in a passage.
#include "planning/eye_safety.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace swath::planning {
namespace {

constexpr double pupil = 7e-3, small_aperture = 1e-3, optics = 50e-3;  // m

/// Diameter that the exposure is averaged over, m: the pupil where light reaches the retina, 1 mm beyond (exposures below 0.35 s).
double aperture_of(double wavelength) { return wavelength < 1400e-9 ? pupil : small_aperture; }

double c4(double nm) { return std::pow(10.0, 0.002 * (std::min(nm, 1050.0) - 700.0)); }
double c7(double nm) {
  if (nm <= 1150.0) return 1.0;
  return nm <= 1200.0 ? std::pow(10.0, 0.018 * (nm - 1150.0)) : 8.0 + std::pow(10.0, 0.04 * (nm - 1250.0));
}

/// Distance at which a beam of `energy` J exposes an eye to `limit` J/m2 through an aperture, m: the share of a Gaussian beam of diameter
/// d (1/e) that passes it is 1 - exp(-(aperture / d)^2).
double distance_of(const LaserPulses& l, double limit, double aperture, double gain) {
  const double allowed = limit * std::numbers::pi / 4.0 * aperture * aperture / gain;
  if (allowed >= l.energy) return 0.0;
  return aperture / std::sqrt(-std::log1p(-allowed / l.energy)) / (l.divergence / std::numbers::sqrt2);
}

/// Pulses that meet an eye at `height` while the beam passes over it, at least one.
double pulses_at(const LaserPulses& l, double height, double aperture) {
  const double width = l.divergence + (height > 0.0 ? aperture / height : 0.0);
  return std::max(1.0, l.angular_speed > 0.0 ? l.prf * width / l.angular_speed : 1.0);
}

/// J/m2 of one pulse where `pulses` meet the eye.
double limit_of(const LaserPulses& l, double pulses) {
  const double one = *permissible_exposure(l.wavelength, 0.0);
  return std::min(one, *permissible_exposure(l.wavelength, pulses / std::max(l.prf, 1.0)) / pulses);
}

}  // namespace

std::optional<double> permissible_exposure(double wavelength, double seconds) {
  const double nm = wavelength * 1e9;
  if (!(nm >= 400.0 && nm <= 2600.0)) return std::nullopt;
  if (nm < 700.0) return seconds <= 5e-6 ? 2e-3 : 18.0 * std::pow(seconds, 0.75);
  if (nm < 1050.0) return c4(nm) * (seconds <= 5e-6 ? 2e-3 : 18.0 * std::pow(seconds, 0.75));
  if (nm < 1400.0) return c7(nm) * (seconds <= 1.3e-5 ? 2e-2 : 90.0 * std::pow(seconds, 0.75));
  if (nm >= 1500.0 && nm < 1800.0) return 1e4;
  return seconds <= 1e-3 ? 1e3 : 5600.0 * std::pow(seconds, 0.25);
}

std::optional<EyeSafety> eye_safety(const LaserPulses& l) {
  if (!permissible_exposure(l.wavelength, 0.0)) return std::nullopt;
  const double aperture = aperture_of(l.wavelength);
  EyeSafety out;
  // Higher up the beam is wider in metres but not in angle: the number of pulses settles at once.
  for (int round = 0; round < 20; ++round) {
    out.pulses = pulses_at(l, out.height, aperture);
    out.exposure = limit_of(l, out.pulses);
    out.height = distance_of(l, out.exposure, aperture, 1.0);
  }
  const double gain = aperture == pupil ? std::pow(optics / pupil, 2) : 1.0;  // optics focus what the retina gets alone
  out.with_binoculars = distance_of(l, out.exposure, aperture * std::sqrt(gain), gain);
  return out;
}

}  // namespace swath::planning
