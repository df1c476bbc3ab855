// SPDX-License-Identifier: GPL-3.0-or-later
// A made block as files with a config, as a user has them; what is changed in them is a mistake.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>

#include "calib/block/block_config.h"
#include "calib/block/block_files.h"
#include "calib/block/orientation_table.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "io/text/value_file.h"
#include "tests/calib/block/made_block.h"
#include "tests/world/support.h"

namespace swath::calib::test {

using swath::test::TemporaryFolder;

/// Two strips to and fro with a cross strip; attitudes of some degrees.
inline Making small_making() {
  Making m;
  m.layout.strips = 3, m.layout.images = 6, m.layout.side = 0.4;
  m.which = {"", DriftSets::none, ControlLayout::chains, 2};
  m.attitudes = true;
  return m;
}

inline std::string text_of(std::initializer_list<double> values) {
  std::string out;
  for (const double v : values) out += "," + core::format_number(v);
  return out;
}

/// What is written, before it is.
struct MadeFiles {
  ImageBlock block;                                                                                                ///< as given: noisy
  std::string y = "up", angles = "omega_phi_kappa", stated_angles = "omega_phi_kappa", angle_use = "start", more;  ///< config
  std::string drift = "none";
  bool write_angles = false;
  double control_unit = 1.0;  ///< coordinates are divided by it
};

inline std::string write_made(const MadeFiles& m, const std::filesystem::path& folder) {
  std::ofstream images(folder / "images.csv"), points(folder / "points.csv"), control(folder / "control.csv"),
      heights(folder / "heights.csv"), checks(folder / "checks.csv");
  const bool body = m.angles == "roll_pitch_heading";
  images << "name,strip,time,x,y,z" << (m.write_angles ? body ? ",roll,pitch,heading" : ",omega,phi,kappa" : "") << "\n";
  for (std::uint32_t i = 0; i < m.block.images.size(); ++i) {
    const BlockImage& image = m.block.images[i];
    Eigen::Vector3d at = image.position;
    for (const ImageStation& s : m.block.stations)
      if (s.image == i) at = s.position;
    images << image.name << "," << image.strip << text_of({image.time, at.x(), at.y(), at.z()});
    if (m.write_angles) {
      const Eigen::Matrix3d R = m.block.attitudes[i].local_R_body;
      Eigen::Matrix3d ned_R_enu;
      ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
      const core::Attitude a = core::attitude_of(ned_R_enu * R);
      const Eigen::Matrix3d M = R * m.block.cameras[0].body_R_camera;
      Eigen::Vector3d angles = omega_phi_kappa_of(M);
      if (m.angles == "phi_omega_kappa") {  // Ry(phi) Rx(omega) Rz(kappa)
        angles.x() = std::asin(-M(1, 2));
        angles.y() = std::atan2(M(0, 2), M(2, 2));
        angles.z() = std::atan2(M(1, 0), M(1, 1));
      }
      if (body) angles = {a.roll, a.pitch, a.heading};
      images << text_of({angles.x() / core::degree, angles.y() / core::degree, angles.z() / core::degree});
    }
    images << "\n";
  }
  points << "image,point,x,y\n";
  for (const ImageRay& r : m.block.rays)
    points << m.block.images[r.image].name << "," << m.block.points[r.point].name << text_of({r.x, r.y}) << "\n";
  for (std::ofstream* f : {&control, &heights, &checks}) *f << "name,x,y,z\n";
  bool any_check = false;
  for (const BlockControl& c : m.block.control) {
    std::ofstream& to = c.check ? checks : c.known[0] ? control : heights;
    any_check = any_check || c.check;
    const Eigen::Vector3d p = c.position / m.control_unit;
    to << m.block.points[c.point].name << text_of({p.x(), p.y(), p.z()}) << "\n";
  }
  std::ofstream config(folder / "block.toml");
  config << "kind = \"block_adjust\"\ncrs = \"local\"\ndrift = \"" << m.drift
         << "\"\n[images]\nfile = \"images.csv\"\nsigma_station_h = \"30 cm\"\n"
         << "sigma_station_v = \"30 cm\"\n";
  if (m.write_angles)
    config << "angles = \"" << m.stated_angles << "\"\nnorth = \"grid\"\nangle_use = \"" << m.angle_use << "\"\n"
           << "sigma_angle = \"0.0057295779513 deg\"\nsigma_heading = \"0.0057295779513 deg\"\n";
  config << "[[camera]]\nname = \"RMK\"\nf = \"" << core::format_number(m.block.cameras[0].value[0])
         << " mm\"\ncolumns = 23000\nrows = 23000\npixel = \"10 um\"\n"
         << "[[image_points]]\nfile = \"points.csv\"\nunit = \"mm\"\norigin = \"middle\"\ny = \"" << m.y << "\"\nsigma = \"10 um\"\n"
         << "[[control]]\nfile = \"control.csv\"\nsigma_horizontal = \"30 cm\"\nsigma_vertical = \"30 cm\"\n"
         << "[[control]]\nfile = \"heights.csv\"\nkind = \"z\"\nsigma_vertical = \"30 cm\"\n";
  if (any_check) config << "[[control]]\nfile = \"checks.csv\"\nuse = \"check\"\n";
  config << m.more;
  config.close();
  return (folder / "block.toml").string();
}

inline BlockConfig read_made(const std::string& file) { return read_block_config(file, io::read_value_file(file)); }

}  // namespace swath::calib::test
