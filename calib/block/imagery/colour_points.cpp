// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/colour_points.h"

#include <algorithm>
#include <limits>

#include "calib/block/imagery/image_colours.h"
#include "calib/block/imagery/local_patch.h"
#include "calib/block/imagery/sight.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

/// Where the first points of a block lie.
struct Extent {
  core::Box box{};
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;

  Extent(const core::Block& b, size_t own) {
    constexpr double none = std::numeric_limits<double>::infinity();
    box = {none, none, -none, -none};
    for (size_t i = 0; i < own; ++i) {
      const Vector3d p = b.origin + Vector3d(b.x[i], b.y[i], b.z[i]);
      box = {std::min(box.x0, p.x()), std::min(box.y0, p.y()), std::max(box.x1, p.x()), std::max(box.y1, p.y())};
      lowest = std::min(lowest, p.z()), highest = std::max(highest, p.z());
    }
  }
};

}  // namespace

ColourCounts colour_points(core::Block& b, size_t own, const OrientedImages& images, const ColourOptions& o) {
  ColourCounts counts{};
  core::add_columns(b, columns(o).gives);
  if (own == 0) return counts;
  const Extent extent(b, own);
  ImageChoice choice(images, extent.box, extent.lowest, o);
  if (choice.empty()) {
    counts.outside += own;
    return counts;
  }
  const LocalPatch local(images, extent.box);
  const core::Grid tops = tops_of(b, o.cell.value);
  const Sight sight(tops, o.reach.value);
  std::vector<ImagePlace> places(own);
  for (size_t i = 0; i < own; ++i) {
    const Vector3d p = b.origin + Vector3d(b.x[i], b.y[i], b.z[i]);
    ImageView view;
    const Seen seen = choice.best(
        p, local(p), [&](const Vector3d& camera) { return sight.is_hidden(p, camera, o.clearance.value); }, view);
    if (seen == Seen::outside) ++counts.outside;
    if (seen == Seen::hidden && o.hidden == HiddenColour::keep) ++counts.hidden;
    if (seen == Seen::seen || (seen == Seen::hidden && o.hidden == HiddenColour::nearest))
      places[i] = {view.image, static_cast<float>(view.pixel.x()), static_cast<float>(view.pixel.y()), 0.0f};
  }
  const std::vector<Colour> colours = colours_of(images, places);
  for (size_t i = 0; i < own; ++i) {
    if (places[i].image == no_image) continue;
    b.red[i] = colours[i][0], b.green[i] = colours[i][1], b.blue[i] = colours[i][2];
    ++counts.coloured;
  }
  return counts;
}

}  // namespace swath::calib
