// SPDX-License-Identifier: GPL-3.0-or-later
// Sources: Ciddor, "Refractive index of air: new equations for the visible and near infrared", Applied Optics 35 (1996) 1566, appendix A
// and B; Ciddor & Hill, "Refractive index of air 2. Group index", Applied Optics 38 (1999) 1663: the Sellmeier terms of dry air and of
// water vapour are differentiated, densities kept; saturation vapour pressure, enhancement factor and compressibility: Giacomo 1982 and
// Davis 1992 (BIPM 1981/91) as Ciddor cites them.
// Deviations. (1) Between scanner and ground n - 1 is exponential in height; a linear fall would give a mean that differs by
// (N0 - N1)^2 / (12 N): 0.2 ppm at 1000 m (0.2 mm), 2 ppm at 3000 m (6 mm). (2) The path ends at `at_ground` whatever the point's own
// height: a roof 100 m above it, seen from 1000 m, gets a mean index wrong by 1.4 ppm, 1.3 mm. (3) Layers are flat: the off-nadir angle
// grows by path / Earth's radius along the way, 1e-4 of the deflection. (4) The bent path is taken as long as its chord (the difference is
// of second order, 1e-11).
#include "georef/atmosphere.h"

#include <algorithm>
#include <cmath>

namespace swath::georef {

namespace {

constexpr double co2 = 450.0;              // ppm by volume
constexpr double gas_constant = 8.314510;  // J/(mol K), the value that belongs to the equations
constexpr double zero_celsius = 273.15;
constexpr double water_molar_mass = 0.018015;  // kg/mol
constexpr double lowest_cosine = 0.1;          // 84 deg off nadir

// 1e8 (n - 1) of dry air at 15 degC, 101325 Pa and of water vapour at 20 degC, 1333 Pa; squared wavenumber in um^-2 (eqs. 1 to 3).
struct Refractivities {
  double air, vapour;
};

Refractivities phase_terms(double s2) {
  const double air = 5792105.0 / (238.0185 - s2) + 167917.0 / (57.362 - s2);
  const double vapour = 1.022 * (295.235 + s2 * (2.6422 + s2 * (-0.032380 + s2 * 0.004028)));
  return {air, vapour};
}

// N + sigma dN/dsigma of the same terms.
Refractivities group_terms(double s2) {
  const auto term = [s2](double k, double k0) { return k * (k0 + s2) / ((k0 - s2) * (k0 - s2)); };
  const double air = term(5792105.0, 238.0185) + term(167917.0, 57.362);
  const double vapour = 1.022 * (295.235 + s2 * (3.0 * 2.6422 + s2 * (5.0 * -0.032380 + s2 * 7.0 * 0.004028)));
  return {air, vapour};
}

// Compressibility of moist air (eq. 12); t degC, x_w molar fraction of vapour.
double compressibility(double t, double p, double x_w) {
  const double T = t + zero_celsius;
  const double q = p / T;
  return 1.0 -
         q * (1.58123e-6 + t * (-2.9331e-8 + t * 1.1043e-10) + x_w * (5.707e-6 - 2.051e-8 * t) + x_w * x_w * (1.9898e-4 - 2.376e-6 * t)) +
         q * q * (1.83e-11 - 0.765e-8 * x_w * x_w);
}

double saturation_vapour_pressure(double T) { return std::exp(1.2378847e-5 * T * T - 1.9121316e-2 * T + 33.93711047 - 6.3431645e3 / T); }

double index_of(const core::Air& air, const Refractivities& standard) {
  const double T = air.temperature.value, p = air.pressure.value, t = T - zero_celsius;
  const double enhancement = 1.00062 + 3.14e-8 * p + 5.6e-7 * t * t;
  const double x_w = std::min(air.humidity * enhancement * saturation_vapour_pressure(T) / p, 1.0);
  const double molar_mass = 1e-3 * (28.9635 + 12.011e-6 * (co2 - 400.0));
  // Densities (eq. 4): of the air and the vapour of the standard terms, and of the parts of the air at hand.
  const double dry_standard = 101325.0 * molar_mass / (compressibility(15.0, 101325.0, 0.0) * gas_constant * 288.15);
  const double vapour_standard = 1333.0 * water_molar_mass / (compressibility(20.0, 1333.0, 1.0) * gas_constant * 293.15);
  const double moles = p / (compressibility(t, p, x_w) * gas_constant * T);
  const double dry = moles * molar_mass * (1.0 - x_w);
  const double vapour = moles * water_molar_mass * x_w;
  const double dry_refractivity = standard.air * (1.0 + 0.534e-6 * (co2 - 450.0));                           // eq. 2
  return 1.0 + 1e-8 * (dry / dry_standard * dry_refractivity + vapour / vapour_standard * standard.vapour);  // eq. 5
}

double squared_wavenumber(double wavelength) {
  const double micrometres = 1e6 * wavelength;
  return 1.0 / (micrometres * micrometres);
}

}  // namespace

double phase_index(const core::Air& air, double wavelength) { return index_of(air, phase_terms(squared_wavenumber(wavelength))); }

double group_index(const core::Air& air, double wavelength) { return index_of(air, group_terms(squared_wavenumber(wavelength))); }

double mean_refractivity(double a, double b) {
  const double x = std::log(a / b);
  constexpr double nearly_equal = 1e-4;  // (a - b) / ln(a / b) loses digits below; the series' next term is x^4 / 1920
  if (std::abs(x) < nearly_equal) return std::sqrt(a * b) * (1.0 + x * x / 24.0);
  return (a - b) / x;
}

AirPath air_path(const core::Scanner& s) {
  AirPath out;
  if (s.air == core::AirModel::none) return out;
  const double wavelength = s.wavelength.value;
  const double group = mean_refractivity(group_index(s.at_sensor, wavelength) - 1.0, group_index(s.at_ground, wavelength) - 1.0);
  const double phase_sensor = phase_index(s.at_sensor, wavelength) - 1.0;
  out.range_factor = s.group_index / (1.0 + group);
  const double phase_mean = mean_refractivity(phase_sensor, phase_index(s.at_ground, wavelength) - 1.0);
  out.bending = (phase_mean - phase_sensor) / (1.0 + phase_sensor);
  return out;
}

Eigen::Vector3d refract(const Eigen::Vector3d& ray, const Eigen::Vector3d& down, double bending) {
  if (bending == 0.0) return ray;
  const double range2 = ray.squaredNorm();
  const double height = std::max(ray.dot(down), lowest_cosine * std::sqrt(range2));
  // Deflection bending * tan(z) towards the nadir: range * bending * (down / cos z - direction).
  return ray + bending * ((range2 / height) * down - ray);
}

Eigen::Matrix3d refract_jacobian(const Eigen::Vector3d& ray, const Eigen::Vector3d& down, double bending) {
  Eigen::Matrix3d J = (1.0 - bending) * Eigen::Matrix3d::Identity();
  if (bending == 0.0) return J;
  const double range2 = ray.squaredNorm(), range = std::sqrt(range2), height = ray.dot(down);
  if (height > lowest_cosine * range)
    J += bending * (down * (2.0 * ray - (range2 / height) * down).transpose()) / height;
  else
    J += bending / (lowest_cosine * range) * (down * ray.transpose());
  return J;
}

}  // namespace swath::georef
