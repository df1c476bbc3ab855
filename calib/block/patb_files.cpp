// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/patb_files.h"

#include <algorithm>
#include <cstdio>

#include "core/printable.h"

namespace swath::calib {
namespace {

constexpr double micrometres_in_mm = 1e3;  // in a mm

template <class... V>
std::string line(const char* form, V... values) {
  char text[200];
  std::snprintf(text, sizeof text, form, values...);
  return text;
}

bool is_name(const std::string& s) {
  constexpr size_t longest = 15;
  return !s.empty() && s.size() <= longest && s.find_first_of(" \t#") == std::string::npos && s != "-99" && s != "-999";
}

}  // namespace

std::vector<std::string> patb_names(const std::vector<std::string>& names) {
  if (std::all_of(names.begin(), names.end(), is_name)) return names;
  std::vector<std::string> out;
  for (size_t k = 0; k < names.size(); ++k) out.push_back(std::to_string(k + 1));
  return out;
}

std::string patb_image_coordinates(const std::vector<PatbPhoto>& photos, const std::vector<std::string>& names,
                                   const std::vector<std::string>& points, std::vector<PatbMark> marks) {
  std::stable_sort(marks.begin(), marks.end(), [](const PatbMark& a, const PatbMark& b) { return a.photo < b.photo; });
  std::string out;
  for (size_t k = 0; k < marks.size(); ++k) {
    const PatbMark& m = marks[k];
    if (k == 0 || marks[k - 1].photo != m.photo)
      out += line("%16s %15.4f\n", names[m.photo].c_str(), micrometres_in_mm * photos[m.photo].principal_distance);
    out += line("%16s %15.4f %15.4f\n", points[m.point].c_str(), micrometres_in_mm * m.x, micrometres_in_mm * m.y);
    if (k + 1 == marks.size() || marks[k + 1].photo != m.photo) out += line("%16s\n", "-99");
  }
  return out;
}

std::string patb_orientations(const std::vector<PatbPhoto>& photos, const std::vector<std::string>& names) {
  std::string out;
  for (size_t k = 0; k < photos.size(); ++k) {
    const Eigen::Vector3d& X = photos[k].map;
    const Eigen::Matrix3d& R = photos[k].grid_R_camera;
    out += line("%16s%16s%16.5f%16.5f%16.5f\n", names[k].c_str(), "", X.x(), X.y(), X.z());
    out += line("%16.12f%16.12f%16.12f%16.12f%16.12f\n", R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1));
    out += line("%16.12f%16.12f%16.12f%16.12f\n", R(1, 2), R(2, 0), R(2, 1), R(2, 2));
  }
  return out;
}

std::string patb_name_table(const std::vector<std::string>& photos, const std::vector<std::string>& patb_photos,
                            const std::vector<std::string>& points, const std::vector<std::string>& patb_points) {
  std::string rows;
  const auto add = [&](const char* kind, const std::vector<std::string>& names, const std::vector<std::string>& patb) {
    if (names == patb) return;
    for (size_t k = 0; k < names.size(); ++k) rows += std::string(kind) + "," + patb[k] + "," + core::csv_field(names[k]) + "\n";
  };
  add("image", photos, patb_photos);
  add("point", points, patb_points);
  return rows.empty() ? rows : "kind,patb,name\n" + rows;
}

}  // namespace swath::calib
