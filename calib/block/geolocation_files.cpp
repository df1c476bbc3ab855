// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/geolocation_files.h"

#include <cstdio>
#include <initializer_list>

#include "calib/block/orientation_table.h"
#include "core/config/units.h"
#include "core/printable.h"

namespace swath::calib {
namespace {

struct Field {
  const char* form;
  double value;
};

std::string line_of(const std::string& image, char separator, std::initializer_list<Field> fields) {
  std::string out = image;
  for (const Field& f : fields) {
    char text[48];
    std::snprintf(text, sizeof text, f.form, f.value);
    out += separator;
    out += text;
  }
  return out + "\n";
}

}  // namespace

core::Attitude upper_edge_attitude(const Eigen::Matrix3d& ned_R_camera) {
  Eigen::Matrix3d camera_R_body;
  camera_R_body << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return core::attitude_of(ned_R_camera * camera_R_body);
}

std::string geo_text(const std::string& crs, const std::vector<Geolocation>& images) {
  // OpenDroneMap knows EPSG codes of plane CRSs alone: without "+ellipsoidal" or a vertical part.
  std::string out = (crs.starts_with("EPSG:") ? crs.substr(0, crs.find('+')) : crs) + "\n";
  for (const Geolocation& g : images) {
    const char* const place = plan_decimals(g.map) > 4 ? "%.10f" : "%.4f";
    out += line_of(g.image, ' ',
                   {{place, g.map.x()},
                    {place, g.map.y()},
                    {"%.4f", g.map.z()},
                    {"%.5f", g.attitude.heading / core::degree},
                    {"%.5f", g.attitude.pitch / core::degree},
                    {"%.5f", g.attitude.roll / core::degree},
                    {"%.4f", g.sigma_horizontal},
                    {"%.4f", g.sigma_vertical}});
  }
  return out;
}

std::string geolocation_csv(const std::string& crs, const std::vector<Geolocation>& images, bool geographic) {
  std::string out = "#imagename," + std::string(geographic ? "latitude,longitude" : "easting,northing") +
                    ",z,yaw,pitch,roll,accuracy_horizontal,accuracy_vertical (" + crs + ")\n";
  const char* const place = geographic ? "%.10f" : "%.4f";
  for (const Geolocation& g : images)
    out += line_of(core::csv_field(g.image), ',',
                   {{place, geographic ? g.map.y() : g.map.x()},
                    {place, geographic ? g.map.x() : g.map.y()},
                    {"%.4f", g.map.z()},
                    {"%.5f", g.attitude.heading / core::degree},
                    {"%.5f", g.attitude.pitch / core::degree},
                    {"%.5f", g.attitude.roll / core::degree},
                    {"%.4f", g.sigma_horizontal},
                    {"%.4f", g.sigma_vertical}});
  return out;
}

}  // namespace swath::calib
