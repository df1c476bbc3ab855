// SPDX-License-Identifier: GPL-3.0-or-later
#include "planning/profiling.h"

#include <gtest/gtest.h>

#include "core/config/units.h"
#include "io/text/value_file.h"
#include "planning/error_budget.h"
#include "tests/world/support.h"

namespace swath::planning {
namespace {

constexpr double relative = 1e-9;

void near(double value, double expected) { EXPECT_NEAR(value, expected, relative * std::abs(expected)); }

TEST(Profiling, ValuesOfOurOwn) {
  near(footprint(0.25e-3, 800), 0.2);
  near(time_of_flight(299792458.0 / 2), 1.0);
  near(swath_width(100, std::atan(1.0)), 200);
  near(height_of_swath(swath_width(731, 0.3), 0.3), 731);
  near(spacing_across(40, 400, 64000), 0.5);
  near(spacing_along(60, 40), 0.75);
  near(density(120000, 60, 500), 4);
  // The density is one pulse per rectangle of both spacings.
  near(density(120000, 60, 500), 1.0 / (spacing_across(40, 500, 120000) * spacing_along(60, 40)));
  EXPECT_NEAR(penetrated_spacing(1.4, 0.2), 3.13, 0.005);  // Brandalize 5.3
  near(c_factor_of(1200, interval_of(1200, 2200)), 2200);
  near(scanned_resolution(50, 20), 1 / std::sqrt(0.0004 + 0.0004));
}

/// Table 02 was computed with 125 knots and swaths rounded to 360, 720 and 1440 m.
TEST(Profiling, TableOfFlights) {
  const double knots = 125 * 1852.0 / 3600.0;
  EXPECT_NEAR(spacing_along(knots, 29), 1.11, 0.005);
  EXPECT_NEAR(spacing_along(knots, 27), 1.19, 0.005);
  EXPECT_NEAR(spacing_along(knots, 19), 1.69, 0.005);
}

TEST(Profiling, Formulas) {
  SWATH_SHARED_OR_SKIP(file, "vectors/p004_formulas.json");
  const core::Value all = io::read_value_file(file);
  const auto rows = [&](const char* name) { return all.find(name)->items(); };
  const auto of = [](const core::Value& row, const char* key) { return row.find(key)->as_number(); };
  for (const auto& r : rows("eq01")) near(footprint(1e-3 * of(r, "alpha_mrad"), of(r, "H")), of(r, "D"));
  for (const auto& r : rows("eq02")) near(1e6 * time_of_flight(of(r, "H")), of(r, "dt_us"));
  for (const auto& r : rows("eq03")) near(swath_width(of(r, "H"), of(r, "beta") * core::degree), of(r, "L"));
  for (const auto& r : rows("eq04")) near(spacing_across(of(r, "f_perfil"), of(r, "L"), of(r, "f_oper")), of(r, "E"));
  for (const auto& r : rows("along_track")) near(spacing_along(of(r, "v"), of(r, "f_perfil")), of(r, "X"));
  for (const auto& r : rows("density")) near(density(of(r, "f_oper"), of(r, "v"), of(r, "L")), of(r, "per_m2"));
  for (const auto& r : rows("eq12")) near(photo_planimetry * of(r, "H"), of(r, "esp"));
  for (const auto& r : rows("eq13")) near(photo_height * of(r, "H"), of(r, "esp"));
  for (const auto& r : rows("eq14_table08")) near(interval_of(of(r, "H"), of(r, "C")), of(r, "interval"));
  for (const auto& r : rows("table07")) near(scanned_resolution(of(r, "film"), of(r, "scanner_um")), of(r, "resolution"));
  for (const auto& r : rows("eq15")) near(100 * *forest_sigma(of(r, "slope_deg") * core::degree, 0.25), of(r, "sigma_cm"));
  for (const auto& r : rows("eq16")) near(without_reference(of(r, "ep_l"), of(r, "ep_f")), of(r, "result"));
}

}  // namespace
}  // namespace swath::planning
