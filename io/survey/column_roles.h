// SPDX-License-Identifier: GPL-3.0-or-later
// What the columns of a table of records are likely to hold, by their names.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace swath::io {

/// The list of survey.toml that a table of records belongs to; `none` where its names do not say.
enum class TableKind { none, laser, imu, gnss, trajectory, event, image_points, control };

struct ColumnRoles {
  TableKind kind = TableKind::none;
  std::vector<std::pair<std::string, std::string>> columns{};  ///< key of [columns]; name, or number of one that occurs twice
  std::string angle_unit{};                                    ///< "deg" or "rad" as the names state it; empty: they do not, or mixed
  bool mixed_angles = false;                                   ///< some names state deg, others rad
  std::string altitude{};                                      ///< the height's name, where it may count from sea level
  bool is_on_map = false;                                      ///< latitude and longitude are northing and easting of a map
  bool has_open_axes = false;                                  ///< "X" and "Y": which of them is the northing is not known
  bool has_rival_headings = false;                             ///< yaw and azimuth: which of them is the heading is not known
  std::vector<std::string> foreign_units{};                    ///< names of columns in units that are not read
  std::string acceleration_unit{};                             ///< "m/s2" or "g"
  std::string imu_kind{};                                      ///< "increments" or "rates"
  std::string time_scale{};                                    ///< "gps_week" (seconds of week), "unix"
  std::string time_unit{};                                     ///< "1 ms" where times are no seconds
};

/// Judges a header by common names with their unit endings ("lat_deg", "gyro_x_radps", "Latitude (deg)"). Columns that only have numbers
/// have none. `units`: of each column by a row below the names, "" for none; those in the names go first.
ColumnRoles roles_of(const std::vector<std::string>& names, const std::vector<std::string>& units = {});

/// The columns "name", "x", "y", "z" of surveyed points by usual names in English and German ("Easting", "Hochwert", "Z [m]"). A coordinate
/// is left out where none of the names is one of it, or several are and none is its key.
ColumnRoles roles_of_control(const std::vector<std::string>& names);

}  // namespace swath::io
