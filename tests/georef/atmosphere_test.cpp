// SPDX-License-Identifier: GPL-3.0-or-later
#include "georef/atmosphere.h"

#include <gtest/gtest.h>

#include <cmath>

namespace swath::georef {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

core::Air air(double celsius, double pascals, double humidity) {
  core::Air a;
  a.temperature = core::Kelvin(celsius + 273.15);
  a.pressure = core::Pascals(pascals);
  a.humidity = humidity;
  return a;
}

double refractivity(double celsius, double kilopascals, double humidity, double nanometres = 633.0) {
  return 1e8 * (phase_index(air(celsius, 1e3 * kilopascals, humidity), 1e-9 * nanometres) - 1.0);
}

// Ciddor 1996, table 1 (dry air, 633 nm): printed to 0.1e-8.
TEST(Atmosphere, CiddorTable1) {
  constexpr double printed = 0.15;
  EXPECT_NEAR(refractivity(20, 80, 0), 21458.0, printed);
  EXPECT_NEAR(refractivity(20, 100, 0), 26824.4, printed);
  EXPECT_NEAR(refractivity(20, 120, 0), 32191.6, printed);
  EXPECT_NEAR(refractivity(10, 100, 0), 27774.7, printed);
  EXPECT_NEAR(refractivity(30, 100, 0), 25937.2, printed);
}

// Ciddor 1996, table 3 (moist air, 633 nm). The row at 40 degC, 80 kPa is misprinted as 19996.5.
TEST(Atmosphere, CiddorTable3) {
  constexpr double printed = 0.15;
  EXPECT_NEAR(refractivity(20, 80, 0.75), 21394.0, printed);
  EXPECT_NEAR(refractivity(20, 120, 0.75), 32127.8, printed);
  EXPECT_NEAR(refractivity(40, 80, 0.75), 19896.5, printed);
  EXPECT_NEAR(refractivity(40, 120, 0.75), 29941.8, printed);
  EXPECT_NEAR(refractivity(50, 80, 1.0), 19058.4, printed);
  EXPECT_NEAR(refractivity(50, 120, 1.0), 28792.4, printed);
}

// NIST Engineering Metrology Toolbox (Ciddor equation, its own saturation pressure), 20 degC, 101325 Pa, 50 %: printed to 1e-9.
TEST(Atmosphere, NistCalculator) {
  constexpr double other_vapour_pressure = 0.15;
  EXPECT_NEAR(refractivity(20, 101.325, 0.5, 500.0), 27378.1, other_vapour_pressure);
  EXPECT_NEAR(refractivity(20, 101.325, 0.5, 633.0), 27137.3, other_vapour_pressure);
  EXPECT_NEAR(refractivity(20, 101.325, 0.5, 700.0), 27065.7, other_vapour_pressure);
  EXPECT_NEAR(refractivity(20, 101.325, 0.5, 1000.987), 26903.8, other_vapour_pressure);
  EXPECT_NEAR(refractivity(20, 101.325, 0.5, 1700.0), 26804.1, other_vapour_pressure);
  EXPECT_NEAR(refractivity(15, 101.325, 0.0, 633.0), 27653.0, 1.0);
}

TEST(Atmosphere, GroupIndexIsTheDerivativeOfThePhaseIndex) {
  constexpr double h = 1e-10;
  for (const double wavelength : {532e-9, 905e-9, 1064e-9, 1550e-9})
    for (const double humidity : {0.0, 1.0}) {
      const core::Air a = air(25.0, 95000.0, humidity);
      const double slope = (phase_index(a, wavelength + h) - phase_index(a, wavelength - h)) / (2.0 * h);
      EXPECT_NEAR(group_index(a, wavelength), phase_index(a, wavelength) - wavelength * slope, 1e-11);
    }
}

// Closed formula of the International Association of Geodesy (resolution 3, Birmingham 1999), from the same work: dry air, 0 degC, 1013.25
// hPa.
TEST(Atmosphere, GroupIndexAgreesWithTheIagFormula) {
  constexpr double iag_own_accuracy = 0.25e-6;
  for (const double um : {0.532, 0.85, 1.064, 1.55}) {
    const double iag = 287.6155 + 4.88660 / (um * um) + 0.06800 / (um * um * um * um);
    EXPECT_NEAR(group_index(air(0.0, 101325.0, 0.0), um * 1e-6), 1.0 + 1e-6 * iag, iag_own_accuracy);
  }
}

TEST(Atmosphere, MeanOfTheExponentialProfile) {
  const double n0 = 2.4e-4, n1 = 2.8e-4;
  double sum = 0.0;
  constexpr int steps = 100000;
  for (int i = 0; i < steps; ++i) sum += n0 * std::pow(n1 / n0, (i + 0.5) / steps);
  EXPECT_NEAR(mean_refractivity(n0, n1), sum / steps, 1e-14);
  EXPECT_NEAR(mean_refractivity(n0, n0), n0, 1e-18);
  EXPECT_NEAR(mean_refractivity(n0, n0 * (1 + 0.9e-4)), mean_refractivity(n0, n0 * (1 + 1.1e-4)), 1e-5 * n0);
}

core::Scanner flying_at_1000_m() {
  core::Scanner s;
  s.air = core::AirModel::ciddor;
  s.at_ground = air(15.0, 101325.0, 0.5);
  s.at_sensor = air(8.5, 89875.0, 0.5);  // international standard atmosphere at 1000 m
  return s;
}

TEST(Atmosphere, RangesShrinkByTheMeanGroupIndex) {
  core::Scanner s = flying_at_1000_m();
  EXPECT_NEAR(1000.0 * (1.0 - air_path(s).range_factor), 0.265, 0.005);  // 27 cm in a kilometre against vacuum
  s.group_index = 1.000265;
  EXPECT_NEAR(1000.0 * (1.0 - air_path(s).range_factor), 0.0, 0.005);
  s.air = core::AirModel::none;
  EXPECT_EQ(air_path(s).range_factor, 1.0);
  EXPECT_EQ(air_path(s).bending, 0.0);
}

// A ray traced through ten thousand layers by Snell's law.
TEST(Atmosphere, RefractionMeetsATracedRay) {
  const core::Scanner s = flying_at_1000_m();
  const double n0 = phase_index(s.at_sensor, s.wavelength.value) - 1.0, n1 = phase_index(s.at_ground, s.wavelength.value) - 1.0;
  const double bending = air_path(s).bending;
  EXPECT_NEAR(bending, 1.3e-5, 0.2e-5);
  for (const double off_nadir : {0.0, 10.0, 20.0, 30.0, 45.0}) {
    const double z0 = core::degrees(off_nadir).value;
    double across = 0.0, length = 0.0;
    constexpr int layers = 10000;
    for (int i = 0; i < layers; ++i) {
      const double n = 1.0 + n0 * std::pow(n1 / n0, (i + 0.5) / layers);
      const double sine = (1.0 + n0) * std::sin(z0) / n;
      const double step = 1000.0 / layers / std::sqrt(1.0 - sine * sine);
      across += step * sine;
      length += step;
    }
    const Vector3d down = Vector3d::UnitZ();
    const Vector3d bent = refract(length * Vector3d(0.0, std::sin(z0), std::cos(z0)), down, bending);
    EXPECT_NEAR(bent.y(), across, 2e-6);
    EXPECT_NEAR(bent.z(), 1000.0, 2e-6);
    // The sizes that the header states.
    const double displaced = std::hypot(length * std::sin(z0) - across, length * std::cos(z0) - 1000.0);
    if (off_nadir == 20.0) {
      EXPECT_NEAR(displaced, 5e-3, 0.5e-3);
    }
    if (off_nadir == 30.0) {
      EXPECT_NEAR(displaced, 9e-3, 0.9e-3);
    }
  }
}

TEST(Atmosphere, RefractionDerivative) {
  const Vector3d down = Vector3d(0.1, -0.2, 0.9).normalized();
  constexpr double bending = 1e-2, h = 1e-3;  // much more than air has, to be seen
  for (const Vector3d& ray : {Vector3d(100, 200, 800), Vector3d(0, 0, 1000), Vector3d(1000, 0, -20), Vector3d(-900, 100, 105)}) {
    Matrix3d difference;
    for (int k = 0; k < 3; ++k)
      difference.col(k) =
          (refract(ray + h * Vector3d::Unit(k), down, bending) - refract(ray - h * Vector3d::Unit(k), down, bending)) / (2.0 * h);
    EXPECT_LT((refract_jacobian(ray, down, bending) - difference).norm(), 1e-8);
  }
  const Vector3d level(1000.0, 0.0, 0.0);
  EXPECT_LT((refract(level, Vector3d::UnitZ(), 1e-5) - level).norm(), 0.11);  // bounded where the tangent is not
}

}  // namespace
}  // namespace swath::georef
