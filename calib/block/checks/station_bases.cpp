// SPDX-License-Identifier: GPL-3.0-or-later
// The base is the move of common points between two images, as if both were level, times flying height over principal distance. The height
// is not known, its neighbours' is nearly the same. Attitudes must be known to a degree: 3 deg move points by a fifth of a base. Images
// taken on nearly one place, as by a drone that hovers, show nothing but the errors of stations and attitudes.
#include "calib/block/checks/station_bases.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <unordered_map>

#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double least_move = 0.05;  // over the flying height

using Points = std::unordered_map<std::uint32_t, Eigen::Vector2d>;

/// Length of the median move of common points; 0: too few of them.
double move_between(const Points& a, const Points& b) {
  std::vector<double> x, y;
  for (const auto& [point, at] : a)
    if (const auto other = b.find(point); other != b.end())
      x.push_back(other->second.x() - at.x()), y.push_back(other->second.y() - at.y());
  constexpr size_t enough = 4;
  return x.size() < enough ? 0.0 : std::hypot(core::median(x), core::median(y));
}

/// Directions of an image's points, by their plane at the distance 1 below it.
std::vector<Points> levelled(const ImageBlock& block) {
  std::vector<Points> out(block.images.size());
  for (const ImageRay& r : block.rays) {
    const BlockImage& image = block.images[r.image];
    const BlockCamera& camera = block.cameras[image.camera];
    const auto d = direction_of(camera.value, camera.distortion, {r.x, r.y});
    if (!d) continue;
    const Eigen::Vector3d u = image.camera_R_local.transpose() * *d;
    if (u.z() < 0.0) out[r.image].try_emplace(r.point, -u.head<2>() / u.z());
  }
  return out;
}

/// Ratios of one strip over the median of up to four neighbours.
void add_strip(const ImageBlock& block, std::vector<std::uint32_t> images, const std::vector<Points>& points,
               std::vector<StationBase>& out) {
  std::sort(images.begin(), images.end(), [&](auto a, auto b) { return block.images[a].time < block.images[b].time; });
  std::vector<StationBase> strip;
  for (size_t k = 1; k < images.size(); ++k) {
    const std::uint32_t a = images[k - 1], b = images[k];
    const double move = move_between(points[a], points[b]);
    if (move > least_move) strip.push_back({a, b, (block.images[b].position - block.images[a].position).norm() / move});
  }
  for (size_t k = 0; k < strip.size(); ++k) {
    std::vector<double> around;
    for (size_t n = k >= 2 ? k - 2 : 0; n < strip.size() && n <= k + 2; ++n)
      if (n != k) around.push_back(strip[n].ratio);
    const double usual = around.size() < 2 ? 0.0 : core::median(around);
    if (usual > 0.0) out.push_back({strip[k].from, strip[k].to, strip[k].ratio / usual});
  }
}

}  // namespace

std::vector<StationBase> station_bases(const ImageBlock& block) {
  const std::vector<Points> points = levelled(block);
  std::map<int, std::vector<std::uint32_t>> strips;
  for (std::uint32_t i = 0; i < block.images.size(); ++i) strips[block.images[i].strip].push_back(i);
  std::vector<StationBase> out;
  for (const auto& [strip, images] : strips) add_strip(block, images, points, out);
  return out;
}

void refuse_broken_bases(const ReadBlock& read, const BlockConfig& config) {
  constexpr double least = 0.3, most = 1.7;
  if (read.stations_observed == 0) return;
  const StationBase* worst = nullptr;
  const std::vector<StationBase> bases = station_bases(read.block);
  const auto off = [](const StationBase& b) { return std::max(b.ratio / most, least / std::max(b.ratio, 1e-3)); };
  for (const StationBase& b : bases)
    if (off(b) > 1.0 && (!worst || off(b) > off(*worst))) worst = &b;
  if (!worst) return;
  char times[40];
  std::snprintf(times, sizeof times, "%.2f", worst->ratio);
  const BlockImage &a = read.block.images[worst->from], &b = read.block.images[worst->to];
  throw core::Error("the stations of images " + a.name + " and " + b.name + " of strip " + std::to_string(a.strip) + " lie " + times +
                        " times as far apart as their image points show and their neighbours in the strip do",
                    place_of_images(config),
                    worst->ratio > 1.0
                        ? "the event of " + b.name + " may be missing, and those after it shifted by one image: match by time"
                        : "an event may be listed twice: match images and events by their time");
}

}  // namespace swath::calib
