// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/joint_covariance.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string_view>

#include "core/error.h"
#include "core/printable.h"
#include "io/text/text_table.h"

namespace swath::calib {
namespace {

constexpr std::array<std::string_view, 6> pose_keys{"east", "north", "up", "about_x", "about_y", "about_z"};
constexpr const char *of_camera = "camera", *of_image = "image";

template <class M, class Keys>
void put_rows(const char* of, const std::string& name, const M& m, const Keys& keys, std::string& out) {
  for (Eigen::Index r = 0; r < m.rows(); ++r) {
    out += std::string(of) + "," + core::csv_field(name) + "," + std::string(keys[static_cast<size_t>(r)]);
    for (Eigen::Index c = 0; c < m.cols(); ++c) {
      char text[32];
      std::snprintf(text, sizeof text, ",%.8e", m(r, c));
      out += text;
    }
    out += "\n";
  }
}

template <class Keys>
Eigen::Index row_of(const Keys& keys, const std::string& key, const std::string& place) {
  const auto at = std::find(keys.begin(), keys.end(), key);
  if (at == keys.end()) throw core::Error("'" + key + "' is not a component", place, "`swath block` writes such a file");
  return at - keys.begin();
}

}  // namespace

std::string joint_covariance_csv(const std::string& crs, const JointCovariance& joint) {
  std::string out = "# crs: " + crs +
                    "; covariances of a camera's values (mm, mm^-2, mm^-4, mm^-6, mm^-1) with one another, and with the errors of its "
                    "images: east, north, up of the grid (m), rotation about the camera's x, y, z (rad)\nof,name,component";
  for (const std::string_view key : camera_keys) out += "," + std::string(key);
  out += "\n";
  for (const auto& [name, m] : joint.cameras) put_rows(of_camera, name, m, camera_keys, out);
  for (const auto& [name, m] : joint.images) put_rows(of_image, name, m, pose_keys, out);
  return out;
}

JointCovariance read_joint_covariance(const std::filesystem::path& file) {
  const io::TextTable table(file);
  const size_t of = table.column("of"), name = table.column("name"), component = table.column("component");
  std::array<size_t, camera_values> columns;
  for (size_t k = 0; k < columns.size(); ++k) columns[k] = table.column(std::string(camera_keys[k]));
  JointCovariance out;
  std::map<std::string, int> rows;
  for (size_t r = 0; r < table.rows(); ++r) {
    Eigen::Matrix<double, 1, camera_values> values;
    for (size_t k = 0; k < columns.size(); ++k) values[static_cast<Eigen::Index>(k)] = table.number(r, columns[k]);
    const std::string &kind = table.text(r, of), &key = table.text(r, component);
    if (kind == of_camera)
      out.cameras.try_emplace(table.text(r, name), CameraCovariance::Zero()).first->second.row(row_of(camera_keys, key, table.place(r))) =
          values;
    else if (kind == of_image)
      out.images.try_emplace(table.text(r, name), PoseByCamera::Zero()).first->second.row(row_of(pose_keys, key, table.place(r))) = values;
    else
      throw core::Error("'" + kind + "' is neither camera nor image", table.place(r), "`swath block` writes such a file");
    ++rows[kind + "\n" + table.text(r, name)];
  }
  for (const auto& [key, n] : rows)
    if (n != (key.starts_with(of_camera) ? camera_values : 6))
      throw core::Error("rows of " + key.substr(key.find('\n') + 1) + " are missing or there twice", file.string());
  return out;
}

}  // namespace swath::calib
