// SPDX-License-Identifier: GPL-3.0-or-later
// Digits: times to 0.1 us, positions to 1 um (1e-11 deg), angles to 4e-6 arc seconds, sigmas and covariances to 7 figures.
#include "io/records/trajectory_text.h"

#include <array>
#include <cmath>
#include <string>

#include "core/config/units.h"
#include "core/error.h"
#include "io/text/text_rows.h"

namespace swath::io {
namespace {

constexpr int time_digits = 7, degree_digits = 11, angle_digits = 9, length_digits = 6, figures = 6;
constexpr double seconds_per_day = 86400.0;

/// Times of one file in its scale.
class TimeColumn {
 public:
  TimeColumn(core::TimeScale scale, const std::vector<double>& times, const std::filesystem::path& file) : scale_(scale) {
    if (scale == core::TimeScale::unstated || scale == core::TimeScale::device)
      throw core::usage_error("the time scale of the text is not stated, or a device's own", file.string());
    if (scale == core::TimeScale::utc_day && !times.empty())
      midnight_ = std::floor(core::to_unix(times.front()) / seconds_per_day) * seconds_per_day;
  }
  std::string header() const {
    switch (scale_) {
      case core::TimeScale::gps_week:
        return "gps_week,gps_sow_s";
      case core::TimeScale::gps_adjusted:
        return "gps_adjusted_s";
      case core::TimeScale::unix_utc:
        return "unix_s";
      case core::TimeScale::utc_day:
        return "utc_sod_s";
      default:
        return "gps_s";
    }
  }
  void write(double t, TextRows& rows) const {
    switch (scale_) {
      case core::TimeScale::gps_week:
        rows.number(core::week_of(t), 0);
        rows.number(core::seconds_of_week(t), time_digits);
        break;
      case core::TimeScale::gps_adjusted:
        rows.number(t - core::adjusted_offset, time_digits);
        break;
      case core::TimeScale::unix_utc:
        rows.number(core::to_unix(t), time_digits);
        break;
      case core::TimeScale::utc_day:
        rows.number(core::to_unix(t) - midnight_, time_digits);
        break;
      default:
        rows.number(t, time_digits);
    }
  }

 private:
  core::TimeScale scale_;
  double midnight_ = 0.0;  // of the first record's day, POSIX seconds
};

}  // namespace

void write_trajectory_text(const std::filesystem::path& file, const core::TrajectoryData& t, core::TimeScale scale) {
  const TimeColumn clock(scale, t.time, file);
  std::string header = clock.header() + ",latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,heading_deg";
  if (t.has_velocity()) header += ",v_north_mps,v_east_mps,v_down_mps";
  if (t.has_sigma()) header += ",sigma_north_m,sigma_east_m,sigma_down_m,sigma_roll_deg,sigma_pitch_deg,sigma_heading_deg";
  TextRows rows(file, header + "\n");
  for (size_t i = 0; i < t.size(); ++i) {
    clock.write(t.time[i], rows);
    rows.number(core::to_degrees(t.latitude[i]), degree_digits);
    rows.number(core::to_degrees(t.longitude[i]), degree_digits);
    rows.number(t.height[i], length_digits);
    for (const double angle : {t.roll[i], t.pitch[i], t.heading[i]}) rows.number(core::to_degrees(angle), angle_digits);
    if (t.has_velocity())
      for (const double v : {t.v_north[i], t.v_east[i], t.v_down[i]}) rows.number(v, length_digits);
    if (t.has_sigma()) {
      for (const float s : {t.sigma_north[i], t.sigma_east[i], t.sigma_down[i]}) rows.scientific(s, figures);
      for (const float s : {t.sigma_roll[i], t.sigma_pitch[i], t.sigma_heading[i]})
        rows.scientific(core::to_degrees(static_cast<double>(s)), figures);
    }
    rows.end();
  }
  rows.commit();
}

void write_covariance_text(const std::filesystem::path& file, const core::TrajectoryData& t, core::TimeScale scale) {
  if (t.covariance.empty()) throw core::Error("the trajectory has no covariances to write", file.string());
  constexpr std::array<const char*, 9> names{"north", "east", "down", "v_north", "v_east", "v_down", "roll", "pitch", "heading"};
  const TimeColumn clock(scale, t.covariance.time, file);
  std::string header = clock.header();
  for (size_t i = 0; i < names.size(); ++i)
    for (size_t j = i; j < names.size(); ++j) header += std::string(",") + names[i] + "*" + names[j];
  TextRows rows(file, header + "\n");
  for (size_t k = 0; k < t.covariance.time.size(); ++k) {
    clock.write(t.covariance.time[k], rows);
    for (const double c : t.covariance.upper[k]) rows.scientific(c, figures);
    rows.end();
  }
  rows.commit();
}

}  // namespace swath::io
