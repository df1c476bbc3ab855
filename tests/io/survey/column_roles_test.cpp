// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/column_roles.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace swath::io {
namespace {

std::string column(const ColumnRoles& r, const std::string& key) {
  const auto at = std::find_if(r.columns.begin(), r.columns.end(), [&](const auto& c) { return c.first == key; });
  return at == r.columns.end() ? "" : at->second;
}

TEST(ColumnRoles, ImuByItsIncrements) {
  const auto r = roles_of({"gps_sow_s", "dtheta_x_rad", "dtheta_y_rad", "dtheta_z_rad", "dv_x_mps", "dv_y_mps", "dv_z_mps"});
  EXPECT_EQ(r.kind, TableKind::imu);
  EXPECT_EQ(r.imu_kind, "increments");
  EXPECT_EQ(r.angle_unit, "rad");
  EXPECT_EQ(r.acceleration_unit, "m/s2");
  EXPECT_EQ(r.time_scale, "gps_week");
  EXPECT_EQ(column(r, "accelerometer_z"), "dv_z_mps");
}

TEST(ColumnRoles, ImuByItsRates) {
  const auto r = roles_of({"Time", "GYRO_X_degps", "gyro_y_degps", "gyro_z_degps", "acc_x_g", "acc_y_g", "acc_z_g"});
  EXPECT_EQ(r.kind, TableKind::imu);
  EXPECT_EQ(r.imu_kind, "rates");
  EXPECT_EQ(r.angle_unit, "deg");
  EXPECT_EQ(r.acceleration_unit, "g");
  EXPECT_EQ(r.time_scale, "") << "a column called time does not say its scale";
  EXPECT_EQ(column(r, "gyro_x"), "GYRO_X_degps");
}

TEST(ColumnRoles, FixesHaveOnePositionAndOneFormOfAccuracy) {
  const auto r = roles_of({"t", "lat", "lon", "h", "ecef_x_m", "ecef_y_m", "ecef_z_m", "cov_xx_m2", "cov_xy_m2", "cov_xz_m2", "cov_yy_m2",
                           "cov_yz_m2", "cov_zz_m2", "sd_north_m", "sd_east_m", "sd_down_m"});
  EXPECT_EQ(r.kind, TableKind::gnss);
  EXPECT_EQ(column(r, "latitude"), "lat");
  EXPECT_EQ(column(r, "x"), "");
  EXPECT_EQ(column(r, "cov_yz"), "cov_yz_m2");
  EXPECT_EQ(column(r, "sigma_north"), "");
  EXPECT_EQ(r.angle_unit, "");
}

TEST(ColumnRoles, WithAttitudeItIsATrajectory) {
  EXPECT_EQ(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "yaw"}).kind, TableKind::trajectory);
  EXPECT_EQ(roles_of({"t", "range_m", "scan_angle_deg"}).kind, TableKind::laser);
  const auto events = roles_of({"unix_time_ms", "photo"});
  EXPECT_EQ(events.kind, TableKind::event);
  EXPECT_EQ(events.time_scale, "unix");
  EXPECT_EQ(events.time_unit, "1 ms");
}

TEST(ColumnRoles, ExportsOfOtherPrograms) {
  auto r = roles_of({"TIME", "DISTANCE", "EASTING", "NORTHING", "ELLIPSOID HEIGHT", "LATITUDE", "LONGITUDE", "ELLIPSOID HEIGHT", "ROLL",
                     "PITCH", "HEADING", "ROLL SD", "PITCH SD", "HEADING SD"});
  EXPECT_EQ(r.kind, TableKind::trajectory);
  EXPECT_EQ(column(r, "latitude"), "LATITUDE");
  EXPECT_EQ(column(r, "height"), "5") << "its name stands twice";
  EXPECT_EQ(column(r, "sigma_roll"), "ROLL SD");
  r = roles_of({"Week", "GPSTime", "Latitude", "Longitude", "H-Ell", "Roll", "Pitch", "Heading"});
  EXPECT_EQ(r.kind, TableKind::trajectory);
  EXPECT_EQ(column(r, "height"), "H-Ell");
  r = roles_of({"GPSW", "GPSSoW", "latitude(deg)", "longitude(deg)", "height(m)", "sdn(m)", "sde(m)", "sdu(m)"});
  EXPECT_EQ(r.kind, TableKind::gnss);
  EXPECT_EQ(r.angle_unit, "deg");
  EXPECT_EQ(r.time_scale, "gps_week");
  EXPECT_EQ(column(r, "sigma_up"), "sdu(m)");
  r = roles_of({"t", "lat_deg", "lon_deg", "h_m", "roll_rad", "pitch_rad", "yaw_rad", "sigma_roll_rad"});
  EXPECT_TRUE(r.mixed_angles);
  EXPECT_EQ(r.angle_unit, "");
  EXPECT_EQ(column(r, "sigma_roll"), "") << "one of three";
  EXPECT_NE(roles_of({"time", "distance", "lat"}).kind, TableKind::laser);
  EXPECT_EQ(roles_of({"gps_sow_s", "range_m", "scan_angle_deg", "roll", "pitch"}).kind, TableKind::laser);
  EXPECT_EQ(roles_of({"time", "range_m", "lat_deg", "lon_deg", "h_m"}).kind, TableKind::laser);
}

TEST(ColumnRoles, TrajectoriesOnAMap) {
  const auto r = roles_of({"GpsTime", "Y", "X", "Z", "Roll", "Pitch", "Azimuth"});
  EXPECT_EQ(r.kind, TableKind::trajectory);
  EXPECT_EQ(column(r, "time") + column(r, "latitude") + column(r, "longitude") + column(r, "height") + column(r, "heading"),
            "GpsTimeYXZAzimuth");
  EXPECT_TRUE(r.is_on_map && r.has_open_axes) << "geodesists have x to the north";
  EXPECT_EQ(r.altitude, "Z");
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"SecOfWeek", "Easting", "Northing", "Height", "Roll", "Pitch", "Yaw"},
        {"Time_of_Week (s)", "E", "N", "H", "Roll", "Pitch", "Heading"},
        {"GPSSeconds", "East", "North", "Ell Height", "Roll", "Pitch", "Azimuth"}}) {
    const auto on_map = roles_of(names);
    EXPECT_EQ(on_map.kind, TableKind::trajectory) << names[0];
    EXPECT_EQ(column(on_map, "longitude"), names[1]);
    EXPECT_EQ(column(on_map, "latitude"), names[2]);
    EXPECT_TRUE(on_map.is_on_map && !on_map.has_open_axes);
    EXPECT_EQ(on_map.altitude, "");
  }
  EXPECT_EQ(roles_of({"SecOfWeek", "E", "N", "H", "Roll", "Pitch", "Yaw"}).time_scale, "gps_week");
  // What is there on the globe is not taken from a map.
  EXPECT_FALSE(roles_of({"t", "lat", "lon", "h", "e", "n", "roll", "pitch", "heading"}).is_on_map);
}

TEST(ColumnRoles, TwoMeaningsAreNotGuessed) {
  EXPECT_EQ(roles_of({"t", "lat", "easting", "h", "roll", "pitch", "heading"}).kind, TableKind::none) << "globe and map";
  EXPECT_EQ(roles_of({"t", "north", "e", "h", "roll", "pitch", "heading"}).kind, TableKind::none) << "two ways of naming";
  EXPECT_TRUE(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "yaw", "azimuth"}).has_rival_headings);
  EXPECT_FALSE(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "azimuth"}).has_rival_headings);
  EXPECT_FALSE(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "heading", "azimuth"}).has_rival_headings);
  EXPECT_EQ(column(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "heading", "azimuth"}), "heading"), "heading");
  EXPECT_EQ(roles_of({"t", "lat", "lon", "h", "roll", "pitch", "course"}).kind, TableKind::gnss) << "a course over ground is no heading";
}

TEST(ColumnRoles, UnitsThatAreNotReadAreNamed) {
  const auto r =
      roles_of({"time", "Latitude (dms)", "Longitude (dms)", "H-Ell (ft)", "Roll (arcmin)", "Pitch (arcmin)", "Heading (arcmin)"});
  EXPECT_EQ(r.kind, TableKind::trajectory);
  EXPECT_EQ(r.angle_unit, "");
  EXPECT_EQ(r.foreign_units.size(), 6U);
  EXPECT_EQ(roles_of({"time", "range (ft)"}).foreign_units, (std::vector<std::string>{"range (ft)"}));
  EXPECT_TRUE(roles_of({"time_ms", "range_m"}).foreign_units.empty());
  EXPECT_EQ(roles_of({"t", "lat", "lon", "Altitude (m)", "Altitude (m)"}).altitude, "Altitude (m)");
}

TEST(ColumnRoles, NamesThatSayNothingAreNone) {
  EXPECT_EQ(roles_of({"1", "2", "3", "4", "5", "6", "7"}).kind, TableKind::none);
  EXPECT_EQ(roles_of({"x", "y", "z"}).kind, TableKind::none);
  const auto points = roles_of({"image", "track_id", "x", "y"});
  EXPECT_EQ(points.kind, TableKind::image_points);
  EXPECT_EQ(column(points, "point_column"), "track_id");
  EXPECT_EQ(roles_of({}).kind, TableKind::none);
}

TEST(ColumnRoles, SurveyedPoints) {
  const auto all = [](const std::vector<std::string>& names) {
    const ColumnRoles r = roles_of_control(names);
    return column(r, "name") + "|" + column(r, "x") + "|" + column(r, "y") + "|" + column(r, "z");
  };
  EXPECT_EQ(all({"Name", "X [m]", "Y [m]", "Z [m]"}), "Name|X [m]|Y [m]|Z [m]");
  EXPECT_EQ(all({"Punkt", "Rechtswert", "Hochwert", "H\xc3\xb6he"}), "Punkt|Rechtswert|Hochwert|H\xc3\xb6he");
  EXPECT_EQ(all({"Nr", "Hochwert (m)", "Rechtswert (m)", "H\xf6he (m)"}), "Nr|Rechtswert (m)|Hochwert (m)|H\xf6he (m)") << "Latin-1";
  EXPECT_EQ(all({"P", "Nord", "Ost", "Altitude"}), "P|Ost|Nord|Altitude");
  EXPECT_EQ(all({"x", "easting", "y", "h", "elev"}), "|x|y|") << "a key is clearer than other names, two of which say nothing";
  EXPECT_EQ(roles_of_control({"x", "y"}).kind, TableKind::none);
}

}  // namespace
}  // namespace swath::io
