// SPDX-License-Identifier: GPL-3.0-or-later
// What PAT-B takes and gives: image coordinates and exterior orientations.
//
// Image coordinates: a line "photo principal-distance", lines "point x y", -99; all in um. They count from the principal point, y up, and
// have no distortion. Orientations: three lines per photo, I16,16X,3F16.5 with number and perspective centre, 5F16.12 and 4F16.12 with the
// rotation matrix by rows (PCI Geomatics, "Using Pat-B in OrthoEngine"), which takes the image's axes (x right, y up, z backward) to the
// grid's.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace swath::calib {

struct PatbPhoto {
  std::string name;
  double principal_distance = 0.0;                ///< mm
  Eigen::Vector3d map = Eigen::Vector3d::Zero();  ///< m
  Eigen::Matrix3d grid_R_camera = Eigen::Matrix3d::Identity();
};

struct PatbMark {
  std::uint32_t photo = 0, point = 0;
  double x = 0.0, y = 0.0;  ///< mm, from the principal point, without distortion
};

/// Names as PAT-B can have them: those given, where all are of 15 characters at most without blanks and none ends a list (-99); otherwise
/// numbers from 1.
std::vector<std::string> patb_names(const std::vector<std::string>& names);

/// Photos without marks are left out. `photos`, `points`: names of PAT-B; `marks`: in any order.
std::string patb_image_coordinates(const std::vector<PatbPhoto>& photos, const std::vector<std::string>& names,
                                   const std::vector<std::string>& points, std::vector<PatbMark> marks);
std::string patb_orientations(const std::vector<PatbPhoto>& photos, const std::vector<std::string>& names);

/// Names of PAT-B and those of the block, where they differ: kind, patb, name. Empty where none does.
std::string patb_name_table(const std::vector<std::string>& photos, const std::vector<std::string>& patb_photos,
                            const std::vector<std::string>& points, const std::vector<std::string>& patb_points);

}  // namespace swath::calib
