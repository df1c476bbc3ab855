// SPDX-License-Identifier: GPL-3.0-or-later
// The residual is robust (a median), and of start values: attitudes that are off by some degrees leave a few per cent of the principal
// distance, a wrong convention several times as much.
#include "calib/block/checks/block_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numeric>
#include <set>

#include "calib/block/block_start.h"
#include "calib/block/checks/block_control_checks.h"
#include "calib/block/checks/block_mistakes.h"
#include "calib/block/checks/moved_residuals.h"
#include "calib/block/checks/station_bases.h"
#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double by_accident = 3.0;  // sigmas of image points: below it everything fits
constexpr size_t sampled = 2000;     // points
constexpr size_t sampled_for_strips = 400;

std::string shown(double millimetres) {
  char text[40];
  std::snprintf(text, sizeof text, millimetres < 0.1 ? "%.4f mm" : "%.2f mm", millimetres);
  return text;
}

/// Image points on the sensor, and not on a corner of it.
void refuse_off_sensor(const ReadBlock& read, const BlockConfig& config) {
  constexpr double beyond = 1.05, spread = 0.02;  // of half the sensor
  for (std::uint32_t c = 0; c < config.cameras.size(); ++c) {
    const CameraConfig& camera = config.cameras[c];
    if (!camera.pixel || camera.columns <= 0 || camera.rows <= 0) continue;
    std::vector<double> x, y;
    for (const ImageRay& r : read.block.rays)
      if (read.block.images[r.image].camera == c) x.push_back(std::abs(r.x)), y.push_back(std::abs(r.y));
    if (x.size() < 20) continue;
    constexpr double most = 0.98;  // of the points: single blunders are the adjustment's
    const double side = 1e3 * camera.pixel->value, half_x = side * camera.columns / 2.0, half_y = side * camera.rows / 2.0,
                 far_x = core::quantile(x, most), far_y = core::quantile(y, most);
    const std::string place = config.image_points.front().file.string(),
                      reach = "image points of camera " + camera.name + " reach " + shown(far_x) + " in x and " + shown(far_y) +
                              " in y from the middle, the sensor " + shown(half_x) + " and " + shown(half_y);
    if (far_x > beyond * half_x || far_y > beyond * half_y)
      throw core::Error(reach, place, "check unit, origin and pixel, and that columns and rows are not exchanged");
    if (far_x < spread * half_x && far_y < spread * half_y) throw core::Error(reach, place, "check unit and pixel");
  }
}

constexpr double at_most = 0.2;  // of the principal distance: one strip's mistake shows in the mean of residuals up to this

double mean_of(const std::vector<double>& residuals) {
  double sum = 0.0, count = 0.0;
  for (const double v : residuals) sum += std::min(at_most, v), count += 1.0;
  return sum / std::max(1.0, count);
}

/// Of the tie points on an image that lies elsewhere than in `stated`.
double mean_of_moved(const ImageBlock& block, const ImageBlock& stated) {
  std::vector<char> on_moved(block.points.size(), 0);
  for (const ImageRay& r : block.rays)
    if (block.images[r.image].position != stated.images[r.image].position) on_moved[r.point] = 1;
  std::vector<double> of_moved;
  size_t k = 0;
  const MovedResiduals residuals(block);
  for (const ImageRay& r : tie_rays(block)) {
    if (on_moved[r.point]) of_moved.push_back(residuals.stated()[k]);
    ++k;
  }
  return mean_of(of_moved);
}

/// The strips with the largest residuals, some of them. `residuals`: of tie_rays().
std::vector<int> worst_strips(const ImageBlock& block, const std::vector<double>& residuals) {
  constexpr size_t tried = 6;
  std::map<int, std::pair<double, double>> sums;
  size_t k = 0;
  for (const ImageRay& r : tie_rays(block)) {
    auto& [sum, n] = sums[block.images[r.image].strip];
    sum += std::min(1.0, residuals[k++]), n += 1.0;
  }
  std::vector<std::pair<double, int>> order;
  for (const auto& [strip, sum] : sums) order.emplace_back(-sum.first / sum.second, strip);
  std::sort(order.begin(), order.end());
  std::vector<int> out;
  for (size_t i = 0; i < order.size() && i < tried; ++i) out.push_back(order[i].second);
  return out;
}

/// `times`: by how much residuals must fall.
void refuse_shifted_strip(const ReadBlock& sample, const BlockConfig& config, double times) {
  constexpr double suspicious = 0.02;  // of the principal distance; smaller
  if (sample.stations_observed == 0) return;
  MovedResiduals residuals(sample.block);
  double least = mean_of(residuals.stated());
  if (least < suspicious) return;
  std::optional<Mistake> best;
  ReadBlock other = sample;
  for (Mistake& m : mistakes_within_strips(sample, worst_strips(sample.block, residuals.stated()))) {
    m.instead(other);
    if (const double found = mean_of(residuals.at(other.block)); found < least) best = std::move(m), least = found;
    for (size_t i = 0; i < other.block.images.size(); ++i) other.block.images[i].position = sample.block.images[i].position;
  }
  if (!best) return;
  best->instead(other);
  // Without angles the level start leaves several per cent everywhere: the points of the moved images decide.
  const double before = mean_of_moved(sample.block, other.block), after = mean_of_moved(other.block, sample.block);
  if (times * after > before) return;
  char text[160];
  std::snprintf(text, sizeof text, ": image points are off by %.1f %% of the principal distance (mean) as stated, by %.1f %% otherwise",
                100.0 * before, 100.0 * after);
  throw core::Error(best->what + text, place_of_images(config), best->hint);
}

}  // namespace

StartResidual start_residual(const ImageBlock& given) {
  ImageBlock block = given;
  intersect_points(block);
  const std::vector<char> is_control = points_of_control(block);
  std::vector<double> tie, control;
  for (const ImageRay& r : block.rays) (is_control[r.point] ? control : tie).push_back(ray_residual(block, r));
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
    std::vector<Mistake> mistakes = mistakes_of_image_axes();
    for (Mistake& m : mistakes_of_angles(sample, config)) mistakes.push_back(std::move(m));
    for (Mistake& m : mistakes_of_stations(sample)) mistakes.push_back(std::move(m));
    const Mistake* best = nullptr;
    StartResidual least = stated;
    for (const Mistake& m : mistakes) {
      ReadBlock other = sample;
      m.instead(other);
      const StartResidual found = start_residual(other.block);
      // Tie points that fit speak for the convention: control that lies elsewhere is no mistake of another kind.
      if (found.tie > std::max(clearly * stated.tie, by_accident * sigma)) continue;
      if (clearly * found.sum() < stated.sum() && found.sum() < least.sum()) best = &m, least = found;
    }
    if (best)
      throw core::Error(best->what + ": image points are off by " + shown(stated.sum()) + " (median, at the start values) as stated, by " +
                            shown(least.sum()) + " without that mistake",
                        config.image_points.front().file.string(), best->hint);
  }
  refuse_off_sensor(read, config);
  if (stated.sum() > by_accident * sigma) refuse_shifted_strip(sample_of(read, sampled_for_strips), config, read.started_level ? 2.0 : 1.4);
  if (!read.started_level) refuse_broken_bases(read, config);
  refuse_far_control(sample);
}

void refuse_wrong_stations(const ReadBlock& stated, const ReadBlock& adjusted, const BlockSolution& s, const BlockConfig& config) {
  constexpr double disagree = 5.0;   // sigmas of stations
  constexpr double too_many = 0.05;  // of the image points, without weight
  constexpr auto of_stations = 1u;   // in BlockInference
  const double freedom = s.inference.redundancy_of[of_stations];
  const bool far = freedom > 1.0 && s.weights.station * std::sqrt(s.inference.squares_of[of_stations] / freedom) > disagree;
  if (!far && static_cast<double>(s.without_weight) < too_many * static_cast<double>(stated.block.rays.size())) return;
  ReadBlock turned = stated;  // attitudes by the images, positions by the stations
  for (size_t i = 0; i < turned.block.images.size(); ++i) turned.block.images[i].camera_R_local = adjusted.block.images[i].camera_R_local;
  turned.started_level = false;
  refuse_shifted_strip(sample_of(turned, sampled_for_strips), config, 1.4);
  refuse_broken_bases(turned, config);
}

}  // namespace swath::calib
