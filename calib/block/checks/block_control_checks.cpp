// SPDX-License-Identifier: GPL-3.0-or-later
// Offsets are medians: a few points under wrong names do not hide what is wrong with all of them, nor are they taken for it.
#include "calib/block/checks/block_control_checks.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "calib/block/block_start.h"
#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;
using Change = std::function<Vector3d(const Vector3d&)>;

/// In flying heights. Angles or orientations place points to some metres; a level start leaves tilts of up to 5 deg, which move a point
/// that two images see in a corner by as much as a flying height.
struct Limits {
  double near, far, far_median;  ///< below nothing is said; above it a point, or the median, is taken for wrong
};
Limits limits_of(const ReadBlock& read) {
  if (read.started_level) return {0.2, 1.2, 1.2};
  return {0.02, 0.2, 0.2};
}

struct Offset {
  std::string name, place;
  double length = 0.0;  ///< m
};

std::string metres_text(double m) { return std::to_string(static_cast<long>(std::lround(m))) + " m"; }

/// Where the images see each control point, by rays alone, from where it is surveyed.
std::vector<Offset> control_offsets(const ReadBlock& read, const Change& changed) {
  ImageBlock block = read.block;
  std::vector<BlockControl> control;
  block.control.swap(control);
  intersect_points(block);
  std::vector<int> rays(block.points.size(), 0);
  for (const ImageRay& r : block.rays) ++rays[r.point];
  std::vector<Offset> out;
  for (size_t k = 0; k < control.size(); ++k) {
    if (rays[control[k].point] < 2) continue;
    Vector3d d = block.points[control[k].point].position - read.frame.local_of(changed(read.control[k].map));
    for (int i = 0; i < 3; ++i)
      if (!control[k].known[static_cast<size_t>(i)]) d[i] = 0.0;
    out.push_back({block.points[control[k].point].name, read.control[k].place, d.norm()});
  }
  return out;
}

double median_length(const std::vector<Offset>& offsets) {
  std::vector<double> lengths;
  for (const Offset& d : offsets) lengths.push_back(d.length);
  return core::median(lengths, 0.0);
}

double distance_to_ground(const ImageBlock& block) {
  double points = 0.0, images = 0.0;
  for (const BlockPoint& p : block.points) points += p.position.z() / static_cast<double>(block.points.size());
  for (const BlockImage& i : block.images) images += i.position.z() / static_cast<double>(block.images.size());
  return std::max(1.0, std::abs(images - points));
}

struct Explanation {
  const char *what, *hint;
  Change change;
  double focal = 1.0;     ///< factor on principal distances
  bool of_points = true;  ///< of single control points, which may be those of one file
};

std::vector<Explanation> explanations() {
  const auto scaled = [](double plan, double height) {
    return [=](const Vector3d& p) { return Vector3d(plan * p.x(), plan * p.y(), height * p.z()); };
  };
  const char* const convert = "convert to metres: 1 ft = 0.3048 m";
  return {{"control is in feet", convert, scaled(foot, foot)},
          {"stations are in feet", convert, scaled(1.0 / foot, 1.0 / foot), 1.0, false},
          {"heights of control are in feet", convert, scaled(1.0, foot)},
          {"easting and northing of control are exchanged", "exchange x and y of [[control]]",
           [](const Vector3d& p) { return Vector3d(p.y(), p.x(), p.z()); }},
          {"the principal distance is ten times too small", "check f of [[camera]] and its unit", scaled(1.0, 1.0), 10.0, false},
          {"the principal distance is ten times too large", "check f of [[camera]] and its unit", scaled(1.0, 1.0), 0.1, false}};
}

double explained(const ReadBlock& read, const Explanation& e, double stated) {
  try {
    if (e.focal == 1.0) return median_length(control_offsets(read, e.change));
    ReadBlock other = read;
    for (BlockCamera& c : other.block.cameras) c.value[0] *= e.focal;
    return median_length(control_offsets(other, e.change));
  } catch (const core::Error&) {
    return stated;  // outside the projection
  }
}

/// Some of the points have a mistake in common, as those of one file have.
void refuse_explained(const ReadBlock& read, const std::vector<Offset>& offsets, double limit) {
  constexpr size_t enough = 3;
  std::vector<Offset> far;
  for (const Offset& o : offsets)
    if (o.length > limit) far.push_back(o);
  if (far.size() < enough) return;
  const double stated = median_length(far);
  for (const Explanation& e : explanations()) {
    if (!e.of_points) continue;
    std::vector<Offset> changed;
    try {
      changed = control_offsets(read, e.change);
    } catch (const core::Error&) {
      continue;  // outside the projection
    }
    std::vector<Offset> same;
    for (size_t k = 0; k < offsets.size(); ++k)
      if (offsets[k].length > limit) same.push_back(changed[k]);
    const double found = median_length(same);
    if (clearly * found < stated && found < limit)
      throw core::Error(std::string(e.what) + ": " + std::to_string(far.size()) + " of " + std::to_string(offsets.size()) + " points lie " +
                            metres_text(stated) + " from where the images see them as stated, and " + metres_text(found) +
                            " without that mistake",
                        far.front().place, e.hint);
  }
}

void refuse_some(const std::vector<Offset>& offsets, double limit) {
  std::string names, place;
  double largest = 0.0;
  size_t wrong = 0;
  for (const Offset& o : offsets) {
    if (o.length < limit) continue;
    if (wrong < 5) names += (wrong ? ", " : "") + o.name;
    if (wrong++ == 0) place = o.place;
    largest = std::max(largest, o.length);
  }
  if (wrong == 0) return;
  throw core::Error("control points lie up to " + metres_text(largest) + " from where the images see them: " + names +
                        (wrong > 5 ? " and " + std::to_string(wrong - 5) + " more" : "") + " of " + std::to_string(offsets.size()),
                    place,
                    wrong < offsets.size() ? "check their names and coordinates: two may be exchanged"
                                           : "check the CRS, the order of easting and northing, and the names of the points");
}

}  // namespace

void refuse_far_control(const ReadBlock& read) {
  const std::vector<Offset> offsets = control_offsets(read, [](const Vector3d& p) { return p; });
  if (offsets.empty()) return;
  const double stated = median_length(offsets), height = distance_to_ground(read.block);
  const Explanation* best = nullptr;
  double least = stated / clearly;
  const std::vector<Explanation> known = explanations();
  const Limits limits = limits_of(read);
  if (stated > limits.near * height)
    for (const Explanation& e : known)
      if (const double found = explained(read, e, stated); found < least) best = &e, least = found;
  if (best)
    throw core::Error(std::string(best->what) + ": points lie " + metres_text(least) + " from where the images see them, and " +
                          metres_text(stated) + " as stated",
                      read.control.front().place, best->hint);
  refuse_explained(read, offsets, limits.far * height);
  refuse_some(offsets, (stated > limits.far_median * height ? limits.far_median : limits.far) * height);
}

}  // namespace swath::calib
