// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_start.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Level, in a local frame of east, north, up.
Matrix3d level_body(double heading) {
  Matrix3d local_R_ned;
  local_R_ned << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  return local_R_ned * core::matrix_of({0.0, 0.0, heading});
}

/// Heading of each image along its strip.
std::vector<double> headings(const ImageBlock& block, const std::vector<char>& needed) {
  std::map<int, std::vector<std::uint32_t>> strips;
  for (std::uint32_t i = 0; i < block.images.size(); ++i) strips[block.images[i].strip].push_back(i);
  std::vector<double> out(block.images.size(), 0.0);
  for (auto& [strip, images] : strips) {
    std::sort(images.begin(), images.end(), [&](auto a, auto b) { return block.images[a].time < block.images[b].time; });
    for (size_t k = 0; k < images.size(); ++k) {
      const std::uint32_t before = images[k > 0 ? k - 1 : k], after = images[std::min(k + 1, images.size() - 1)];
      const Vector3d way = block.images[after].position - block.images[before].position;
      if (needed[images[k]] && !(way.head<2>().norm() > 0.0)) {
        const std::string number = std::to_string(strip);
        if (images.size() == 1)
          throw core::Error("strip " + number + " has one image: its direction is not known", "",
                            "give the attitude of image " + block.images[images[k]].name + ", or its strip's other images");
        throw core::Error("images " + block.images[before].name + " and " + block.images[after].name + " of strip " + number +
                              " are at the same place: the direction of flight is not known",
                          "", "an event may be listed twice: match images and events by their time; or give the attitudes");
      }
      out[images[k]] = std::atan2(way.x(), way.y());
    }
  }
  return out;
}

}  // namespace

void set_attitude(ImageBlock& block, std::uint32_t image, const Matrix3d& local_R_body) {
  BlockImage& i = block.images[image];
  i.camera_R_local = (local_R_body * block.cameras[i.camera].body_R_camera).transpose();
}

void start_poses(ImageBlock& block) {
  std::vector<char> has_station(block.images.size(), 0), level(block.images.size(), 1);
  for (const ImageStation& s : block.stations) {
    block.images[s.image].position = s.position;
    has_station[s.image] = 1;
  }
  for (size_t i = 0; i < block.images.size(); ++i)
    if (!has_station[i])
      throw core::Error("image " + block.images[i].name + " has no station to start from", "", "give its position, or leave it out");
  for (const ImageAttitude& a : block.attitudes) {
    set_attitude(block, a.image, a.local_R_body);
    level[a.image] = 0;
  }
  const std::vector<double> heading = headings(block, level);
  for (std::uint32_t i = 0; i < block.images.size(); ++i)
    if (level[i]) set_attitude(block, i, level_body(heading[i]));
  for (BlockImage& i : block.images) i.position -= i.camera_R_local.transpose() * block.cameras[i.camera].antenna;
}

void RayIntersection::add(const Vector3d& from, const Vector3d& direction) {
  const Matrix3d across = Matrix3d::Identity() - direction * direction.transpose();
  N_ += across;
  b_ += across * from;
  ++rays_;
}

std::optional<Vector3d> RayIntersection::point() const {
  constexpr double smallest = 1e-8;  // squared angle between rays, rad^2
  const Eigen::LDLT<Matrix3d> ldlt(N_);
  if (ldlt.vectorD().minCoeff() < smallest) return {};
  return ldlt.solve(b_);
}

size_t intersect_points(ImageBlock& block) {
  std::vector<RayIntersection> sums(block.points.size());
  for (const ImageRay& r : block.rays) {
    const BlockImage& image = block.images[r.image];
    const BlockCamera& camera = block.cameras[image.camera];
    if (const auto d = direction_of(camera.value, camera.distortion, {r.x, r.y}))
      sums[r.point].add(image.position, (image.camera_R_local.transpose() * *d).normalized());
  }
  size_t parallel = 0;
  for (size_t p = 0; p < sums.size(); ++p) {
    if (sums[p].rays() < 2) continue;
    if (const auto point = sums[p].point())
      block.points[p].position = *point;
    else
      ++parallel;
  }
  for (const BlockControl& c : block.control)
    for (int k = 0; k < 3; ++k)
      if (!c.check && c.known[static_cast<size_t>(k)]) block.points[c.point].position[k] = c.position[k];
  return parallel;
}

}  // namespace swath::calib
