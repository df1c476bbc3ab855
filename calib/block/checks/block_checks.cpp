// SPDX-License-Identifier: GPL-3.0-or-later
// The residual is robust (a median), and of start values: attitudes that are off by some degrees leave a few per cent of the principal
// distance, a wrong convention several times as much.
#include "calib/block/checks/block_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/block/block_start.h"
#include "calib/block/checks/block_control_checks.h"
#include "calib/block/checks/block_mistakes.h"
#include "calib/block/checks/block_sample.h"
#include "calib/block/checks/moved_residuals.h"
#include "calib/block/checks/sensor_reach.h"
#include "calib/block/checks/shifted_strip.h"
#include "calib/block/checks/station_bases.h"
#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr double by_accident = 3.0;  // sigmas of image points: below it everything fits
constexpr size_t sampled = 2000;     // points

std::string shown(double millimetres) {
  char text[40];
  std::snprintf(text, sizeof text, millimetres < 0.1 ? "%.4f mm" : "%.2f mm", millimetres);
  return text;
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

void refuse_mistakes(const ReadBlock& read, const BlockConfig& config) {
  if (read.block.rays.empty()) throw core::Error("no image point", config.image_points.front().file.string());
  const ReadBlock sample = sample_of(read, sampled);
  const StartResidual stated = start_residual(sample.block);
  double sigma = 0.0;
  for (const ImageRay& r : sample.block.rays) sigma = std::max(sigma, r.sigma);
  if (stated.sum() > by_accident * sigma) {
    std::vector<Mistake> mistakes = mistakes_of_image_axes();
    for (Mistake& m : mistakes_of_cameras(sample)) mistakes.push_back(std::move(m));
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
  refuse_shifted_strip(read, config, read.started_level ? 2.0 : 1.4);
  if (!read.started_level) refuse_broken_bases(read, config);
  refuse_far_control(sample);
}

void refuse_wrong_stations(const ReadBlock& stated, const ReadBlock& adjusted, const BlockSolution& s, const BlockConfig& config) {
  constexpr double disagree = 5.0;   // sigmas of stations
  constexpr double too_many = 0.05;  // of the image points, without weight
  constexpr auto of_stations = 1u;   // in BlockInference
  if (stated.started_level) {
    ReadBlock oriented = sample_of(adjusted, sampled);  // a level start shows heights in feet on high ground only
    oriented.started_level = false;
    refuse_far_control(oriented);
  }
  const double freedom = s.inference.redundancy_of[of_stations];
  const bool far = freedom > 1.0 && s.weights.station * std::sqrt(s.inference.squares_of[of_stations] / freedom) > disagree;
  if (!far && static_cast<double>(s.without_weight) < too_many * static_cast<double>(stated.block.rays.size())) return;
  ReadBlock turned = stated;  // attitudes by the images, positions by the stations
  for (size_t i = 0; i < turned.block.images.size(); ++i) turned.block.images[i].camera_R_local = adjusted.block.images[i].camera_R_local;
  turned.started_level = false;
  refuse_shifted_strip(turned, config, 1.4);
  refuse_broken_bases(turned, config);
}

}  // namespace swath::calib
