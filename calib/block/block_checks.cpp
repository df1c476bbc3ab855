// SPDX-License-Identifier: GPL-3.0-or-later
// The residual is robust (a median), and of start values: attitudes that are off by some degrees leave a few per cent of the principal
// distance, a wrong convention several times as much.
#include "calib/block/block_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

#include "calib/block/block_start.h"
#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector3d;

constexpr double clearly = 3.0;      // times smaller: another convention fits better
constexpr double by_accident = 3.0;  // sigmas of image points: below it everything fits
constexpr size_t sampled = 2000;     // points

struct Mistake {
  std::string what, hint;
  std::function<void(ReadBlock&)> instead;  // changes a copy to what it would be without the mistake
};

void turn_marks(ReadBlock& read, const Matrix2d& M) {
  for (ImageRay& r : read.block.rays) {
    const Eigen::Vector2d p = M * Eigen::Vector2d(r.x, r.y);
    r.x = p.x(), r.y = p.y();
  }
}

Matrix2d matrix(double a, double b, double c, double d) {
  Matrix2d M;
  M << a, b, c, d;
  return M;
}

std::vector<Mistake> of_image_axes() {
  const auto axes = [](const std::string& what, const std::string& hint, const Matrix2d& M) {
    return Mistake{what, hint, [M](ReadBlock& read) { turn_marks(read, M); }};
  };
  return {axes("the y axis of the image points has the other sense", "state the other of y = \"up\" and y = \"down\"", matrix(1, 0, 0, -1)),
          axes("the images are mirrored (x has the other sense)",
               "image points of a mirrored scan or of negatives: measure in the positive, or turn the sign of x", matrix(-1, 0, 0, 1)),
          axes("the camera is turned by 180 deg", "add 180 deg to camera.mount", matrix(-1, 0, 0, -1)),
          axes("the camera is turned by 90 deg", "take 90 deg off camera.mount", matrix(0, -1, 1, 0)),
          axes("the camera is turned by 90 deg", "add 90 deg to camera.mount", matrix(0, 1, -1, 0)),
          axes("x and y of the image points are exchanged", "exchange x_column and y_column", matrix(0, 1, 1, 0)),
          axes("the images are mirrored and turned by 90 deg", "state the other of y = \"up\" and y = \"down\", and check camera.mount",
               matrix(0, -1, -1, 0))};
}

std::vector<Mistake> of_angles(const ReadBlock& read, const BlockConfig& config) {
  std::vector<Mistake> out;
  const ImageAngles kind = config.images.angles;
  if (kind == ImageAngles::none) return out;
  const auto again = [&](const std::string& what, const std::string& hint, ImageAngles k, ImageNorth north, std::array<double, 3> sign) {
    out.push_back({what, hint, [=](ReadBlock& other) {
                     for (const StatedAngles& a : other.angles) {
                       const std::array<double, 3> v{sign[0] * a.value[0], sign[1] * a.value[1], sign[2] * a.value[2]};
                       set_attitude(other.block, a.image, body_attitude(other, a.image, v, k, north));
                     }
                   }});
  };
  const ImageNorth north = *config.images.north;
  const std::array<double, 3> same{1, 1, 1};
  const bool boresight_held =
      std::all_of(read.block.cameras.begin(), read.block.cameras.end(), [](const BlockCamera& c) { return c.boresight_sigma.isZero(0.0); });
  if (boresight_held)  // an unknown boresight heading is the same to the images
    again("headings (kappa) count from the other north", "state the other of north = \"grid\" and north = \"true\"", kind,
          north == ImageNorth::grid ? ImageNorth::true_north : ImageNorth::grid, same);
  if (kind == ImageAngles::omega_phi_kappa)
    again("the angles are phi omega kappa, not omega phi kappa", "state angles = \"phi_omega_kappa\"", ImageAngles::phi_omega_kappa, north,
          same);
  if (kind == ImageAngles::phi_omega_kappa)
    again("the angles are omega phi kappa, not phi omega kappa", "state angles = \"omega_phi_kappa\"", ImageAngles::omega_phi_kappa, north,
          same);
  static const std::map<ImageAngles, std::array<const char*, 3>> names{{ImageAngles::roll_pitch_heading, {"roll", "pitch", "heading"}},
                                                                       {ImageAngles::omega_phi_kappa, {"omega", "phi", "kappa"}},
                                                                       {ImageAngles::phi_omega_kappa, {"omega", "phi", "kappa"}}};
  for (size_t k = 0; k < 3; ++k) {
    std::array<double, 3> sign = same;
    sign[k] = -1.0;
    again(std::string(names.at(kind)[k]) + " has the other sign", "turn the sign of the column", kind, north, sign);
  }
  again("all angles have the other sign", "the angles may turn the map to the camera: turn their signs and order", kind, north,
        {-1, -1, -1});
  return out;
}

/// Images of each strip in the order of time.
std::map<int, std::vector<std::uint32_t>> flown_strips(const ImageBlock& block) {
  std::map<int, std::vector<std::uint32_t>> strips;
  for (std::uint32_t i = 0; i < block.images.size(); ++i) strips[block.images[i].strip].push_back(i);
  for (auto& [strip, images] : strips)
    std::sort(images.begin(), images.end(), [&](auto a, auto b) { return block.images[a].time < block.images[b].time; });
  return strips;
}

/// Each image at the position of the one after it (`step` 1) or before it (-1); the last one goes on straight.
void shift_positions(ImageBlock& block, int step) {
  for (auto& [strip, images] : flown_strips(block)) {
    if (images.size() < 3) continue;
    std::vector<Vector3d> at;
    for (const std::uint32_t i : images) at.push_back(block.images[i].position);
    const auto n = static_cast<int>(at.size());
    for (int k = 0; k < n; ++k) {
      const int from = k + step;
      const Vector3d beyond = from < 0    ? Vector3d(2.0 * at[0] - at[1])
                              : from >= n ? Vector3d(2.0 * at[static_cast<size_t>(n - 1)] - at[static_cast<size_t>(n - 2)])
                                          : at[static_cast<size_t>(from)];
      block.images[images[static_cast<size_t>(k)]].position = beyond;
    }
  }
}

std::vector<Mistake> of_stations(const ReadBlock& read) {
  if (read.stations_observed == 0) return {};
  const std::string hint = "an event is missing or was counted twice: match images and events by their time";
  return {{"the stations are those of the image before", hint, [](ReadBlock& r) { shift_positions(r.block, 1); }},
          {"the stations are those of the image after", hint, [](ReadBlock& r) { shift_positions(r.block, -1); }}};
}

std::string shown(double millimetres) {
  char text[40];
  std::snprintf(text, sizeof text, millimetres < 0.1 ? "%.4f mm" : "%.2f mm", millimetres);
  return text;
}

/// Where the images see each control point, by rays alone, less where it is surveyed.
std::vector<Vector3d> control_offsets(const ReadBlock& read, double factor) {
  ImageBlock block = read.block;
  std::vector<BlockControl> control;
  block.control.swap(control);
  intersect_points(block);
  std::vector<int> rays(block.points.size(), 0);
  for (const ImageRay& r : block.rays) ++rays[r.point];
  std::vector<Vector3d> out;
  for (size_t k = 0; k < control.size(); ++k) {
    if (rays[control[k].point] < 2) continue;
    Vector3d d = block.points[control[k].point].position - read.frame.local_of(factor * read.control[k].map);
    for (int i = 0; i < 3; ++i)
      if (!control[k].known[static_cast<size_t>(i)]) d[i] = 0.0;
    out.push_back(d);
  }
  return out;
}

double median_length(const std::vector<Vector3d>& offsets) {
  std::vector<double> lengths;
  for (const Vector3d& d : offsets) lengths.push_back(d.norm());
  return core::median(lengths, 0.0);
}

double distance_to_ground(const ImageBlock& block) {
  double points = 0.0, images = 0.0;
  for (const BlockPoint& p : block.points) points += p.position.z() / static_cast<double>(block.points.size());
  for (const BlockImage& i : block.images) images += i.position.z() / static_cast<double>(block.images.size());
  return std::max(1.0, std::abs(images - points));
}

void refuse_feet(const ReadBlock& sample) {
  const std::vector<Vector3d> offsets = control_offsets(sample, 1.0);
  if (offsets.empty()) return;
  constexpr double foot = 0.3048, far = 0.2;
  const double stated = median_length(offsets), height = distance_to_ground(sample.block);
  if (stated < far * height) return;
  for (const auto& [factor, what] : {std::pair{foot, "control is in feet"}, {1.0 / foot, "stations are in feet"}}) {
    double scaled = stated;
    try {
      scaled = median_length(control_offsets(sample, factor));
    } catch (const core::Error&) {
      continue;  // outside the projection
    }
    if (clearly * scaled < stated)
      throw core::Error(std::string(what) + ": points lie " + std::to_string(static_cast<long>(std::lround(scaled))) +
                            " m from where the images see them, and " + std::to_string(static_cast<long>(std::lround(stated))) +
                            " m as stated",
                        sample.control.front().place, "convert to metres: 1 ft = 0.3048 m");
  }
  throw core::Error(
      "control points lie " + std::to_string(static_cast<long>(std::lround(stated))) + " m (median) from where the images see them",
      sample.control.front().place, "check the CRS and the order of easting and northing");
}

}  // namespace

StartResidual start_residual(const ImageBlock& given) {
  ImageBlock block = given;
  intersect_points(block);
  std::vector<char> is_control(block.points.size(), 0);
  for (const BlockControl& c : block.control)
    if (!c.check) is_control[c.point] = 1;
  std::vector<double> tie, control;
  for (const ImageRay& r : block.rays) {
    const BlockImage& i = block.images[r.image];
    const BlockCamera& camera = block.cameras[i.camera];
    const auto seen = image_of(camera.value, camera.distortion, i.camera_R_local * (block.points[r.point].position - i.position));
    const double v = seen ? (*seen - Eigen::Vector2d(r.x, r.y)).norm() : 10.0 * camera.value[0];  // behind the camera
    (is_control[r.point] ? control : tie).push_back(v);
  }
  return {core::median(tie, 0.0), core::median(control, 0.0)};
}

ReadBlock sample_of(const ReadBlock& read, size_t points) {
  const ImageBlock& b = read.block;
  std::vector<std::set<int>> strips(b.points.size());
  std::vector<int> rays(b.points.size(), 0);
  for (const ImageRay& r : b.rays) strips[r.point].insert(b.images[r.image].strip), ++rays[r.point];
  std::vector<char> wanted(b.points.size(), 0);
  for (const BlockControl& c : b.control) wanted[c.point] = 1;
  std::vector<std::uint32_t> order(b.points.size());
  std::iota(order.begin(), order.end(), 0u);
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto c) { return std::pair(strips[a].size(), rays[a]) > std::pair(strips[c].size(), rays[c]); });
  for (size_t k = 0; k < order.size() && k < points; ++k)
    if (rays[order[k]] > 1) wanted[order[k]] = 1;
  ReadBlock out = read;
  out.block.points.clear();
  out.block.rays.clear();
  std::vector<std::uint32_t> number(b.points.size(), 0);
  for (size_t p = 0; p < wanted.size(); ++p)
    if (wanted[p]) number[p] = static_cast<std::uint32_t>(out.block.points.size()), out.block.points.push_back(b.points[p]);
  for (ImageRay r : b.rays)
    if (wanted[r.point]) r.point = number[r.point], out.block.rays.push_back(r);
  for (BlockControl& c : out.block.control) c.point = number[c.point];
  return out;
}

void refuse_mistakes(const ReadBlock& read, const BlockConfig& config) {
  if (read.block.rays.empty()) throw core::Error("no image point", config.image_points.front().file.string());
  const ReadBlock sample = sample_of(read, sampled);
  const StartResidual stated = start_residual(sample.block);
  double sigma = 0.0;
  for (const ImageRay& r : sample.block.rays) sigma = std::max(sigma, r.sigma);
  if (stated.sum() > by_accident * sigma) {
    std::vector<Mistake> mistakes = of_image_axes();
    for (Mistake& m : of_angles(sample, config)) mistakes.push_back(std::move(m));
    for (Mistake& m : of_stations(sample)) mistakes.push_back(std::move(m));
    const Mistake* best = nullptr;
    StartResidual least = stated;
    for (const Mistake& m : mistakes) {
      ReadBlock other = sample;
      m.instead(other);
      const StartResidual found = start_residual(other.block);
      if (clearly * found.sum() < stated.sum() && found.sum() < least.sum()) best = &m, least = found;
    }
    if (best)
      throw core::Error(best->what + ": image points are off by " + shown(stated.sum()) + " (median, at the start values) as stated, by " +
                            shown(least.sum()) + " without that mistake",
                        config.image_points.front().file.string(), best->hint);
  }
  refuse_feet(sample);
}

}  // namespace swath::calib
