// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_start.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/statistics.h"

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

/// Per ray, in the camera's axes; zero where the distortion has no inverse.
std::vector<Vector3d> directions_of(const ImageBlock& block) {
  std::vector<Vector3d> out;
  out.reserve(block.rays.size());
  for (const ImageRay& r : block.rays) {
    const BlockCamera& camera = block.cameras[block.images[r.image].camera];
    const auto d = direction_of(camera.value, camera.distortion, {r.x, r.y});
    out.push_back(d ? *d : Vector3d::Zero());
  }
  return out;
}

/// intersect_points() with the directions of all rays.
size_t intersect(ImageBlock& block, const std::vector<Vector3d>& directions) {
  std::vector<RayIntersection> sums(block.points.size());
  for (size_t r = 0; r < block.rays.size(); ++r) {
    const BlockImage& image = block.images[block.rays[r].image];
    if (!directions[r].isZero())
      sums[block.rays[r].point].add(image.position, (image.camera_R_local.transpose() * directions[r]).normalized());
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

/// Points by intersection, or where it is far from the middle depth of an image's points, the mean of the places at that depth.
void place_points(ImageBlock& block, const std::vector<Vector3d>& directions) {
  constexpr double near = 0.5;  // of the middle depth
  intersect(block, directions);
  std::vector<std::vector<double>> depths(block.images.size());
  const auto depth = [&](const ImageRay& r) { return block.images[r.image].position.z() - block.points[r.point].position.z(); };
  for (size_t r = 0; r < block.rays.size(); ++r)
    if (!directions[r].isZero()) depths[block.rays[r].image].push_back(depth(block.rays[r]));
  std::vector<double> middle;
  for (std::vector<double>& d : depths) middle.push_back(core::median(std::move(d), 0.0));
  std::vector<Vector3d> sum(block.points.size(), Vector3d::Zero());
  std::vector<int> crossings(block.points.size(), 0);
  std::vector<char> far(block.points.size(), 0);
  for (size_t r = 0; r < block.rays.size(); ++r) {
    const double usual = middle[block.rays[r].image];
    if (directions[r].isZero() || !(usual > 0.0)) continue;
    const size_t p = block.rays[r].point;
    const BlockImage& image = block.images[block.rays[r].image];
    const Vector3d local = image.camera_R_local.transpose() * directions[r];
    if (std::abs(depth(block.rays[r]) - usual) > near * usual) far[p] = 1;
    if (!(local.z() < 0.0)) continue;
    sum[p] += image.position - local * (usual / local.z());
    ++crossings[p];
  }
  for (size_t p = 0; p < far.size(); ++p)
    if (far[p] && crossings[p] > 0) block.points[p].position = sum[p] / crossings[p];
}

/// Rotation that takes `from` to `to` with the least sum of squares, weighted (Wahba 1965; Kabsch 1976).
Matrix3d turned(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to, const std::vector<double>& weight) {
  Matrix3d B = Matrix3d::Zero();
  for (size_t k = 0; k < from.size(); ++k) B += weight[k] * to[k] * from[k].transpose();
  const Eigen::JacobiSVD<Matrix3d> svd(B, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant();
  return svd.matrixU() * Vector3d(1.0, 1.0, sign).asDiagonal() * svd.matrixV().transpose();
}

/// Attitude of an image from its points, far ones with less weight.
Matrix3d attitude_of(const Matrix3d& camera_R_local, const std::vector<Vector3d>& seen, const std::vector<Vector3d>& towards) {
  std::vector<double> off;
  for (size_t k = 0; k < seen.size(); ++k) off.push_back((seen[k] - camera_R_local * towards[k]).norm());
  const double scale = std::max(core::median(off, 0.0), 1e-9);
  for (double& o : off) o = 1.0 / (1.0 + o * o / (4.0 * scale * scale));
  return turned(towards, seen, off);
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

void turn_level_images(ImageBlock& block) {
  constexpr int rounds = 12;
  constexpr size_t enough = 3;              // rays
  const double most = 40.0 * core::degree;  // from level: beyond it something else is wrong, which the checks of residuals name
  std::vector<Vector3d> directions = directions_of(block);
  std::vector<int> rays(block.points.size(), 0);
  for (const ImageRay& r : block.rays) ++rays[r.point];
  for (size_t r = 0; r < directions.size(); ++r)
    if (rays[block.rays[r].point] < 2) directions[r].setZero();
  std::vector<Matrix3d> level;
  for (const BlockImage& i : block.images) level.push_back(i.camera_R_local);
  for (int round = 0; round < rounds; ++round) {
    place_points(block, directions);
    std::vector<std::vector<Vector3d>> seen(block.images.size()), towards(block.images.size());
    for (size_t r = 0; r < block.rays.size(); ++r) {
      const std::uint32_t i = block.rays[r].image;
      if (directions[r].isZero()) continue;
      seen[i].push_back(directions[r].normalized());
      towards[i].push_back((block.points[block.rays[r].point].position - block.images[i].position).normalized());
    }
    for (size_t i = 0; i < block.images.size(); ++i) {
      if (seen[i].size() < enough) continue;
      const Matrix3d turned = attitude_of(block.images[i].camera_R_local, seen[i], towards[i]);
      if (Eigen::AngleAxisd(turned * level[i].transpose()).angle() < most) block.images[i].camera_R_local = turned;
    }
  }
  intersect_points(block);
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

size_t intersect_points(ImageBlock& block) { return intersect(block, directions_of(block)); }

}  // namespace swath::calib
