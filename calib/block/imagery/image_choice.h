// SPDX-License-Identifier: GPL-3.0-or-later
// Which photograph a place is best taken from: the one that sees it at the least angle to the vertical.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "calib/block/imagery/oriented_images.h"
#include "core/area.h"
#include "core/config/option.h"

namespace swath::calib {

/// What all that is taken from photographs has in common.
struct SightOptions {
  core::Metres reach{30.0}, clearance{1.0};
  core::Radians off_nadir = core::degrees(60.0);
};

template <class V>
void describe(SightOptions& o, V& v) {
  v.option("reach", o.reach, core::within(0, 500), "Horizontal distance within which something may hide a place from a camera.");
  v.option("clearance", o.clearance, core::within(0, 100), "Objects lower than this above a place do not hide it.");
  v.option("off_nadir", o.off_nadir, core::within(0, 85.0 * core::degree), "Largest angle between a ray and the vertical.");
}

struct ImageView {
  std::uint32_t image = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< from the corner of the first pixel, y down
  double slope = 0.0;                               ///< tangent of the angle to the vertical
};

/// What became of a place.
enum class Seen : std::uint8_t { seen, hidden, outside };

/// The images that may see a box, and the best of them for each place in it. For one thread.
class ImageChoice {
 public:
  /// `lowest`: of the places' heights. The images must outlive this.
  ImageChoice(const OrientedImages& images, const core::Box& box, double lowest, const SightOptions& options);

  bool empty() const { return near_.empty(); }

  /// `map`: on the map, m; `local`: the same in the frame. `is_hidden(camera on the map)`. Of images at the same angle the first.
  template <class Hidden>
  Seen best(const Eigen::Vector3d& map, const Eigen::Vector3d& local, const Hidden& is_hidden, ImageView& view) {
    rank(map);
    Seen seen = Seen::outside;
    for (size_t k = 0; k < ranked_.size(); ++k) {
      std::swap(ranked_[k], *std::min_element(ranked_.begin() + static_cast<std::ptrdiff_t>(k), ranked_.end()));
      const auto [slope, image] = ranked_[k];
      const auto pixel = pixel_of(image, local);
      if (!pixel) continue;
      if (seen == Seen::outside) view = {image, *pixel, slope};
      if (is_hidden(images_.images[image].map)) {
        seen = Seen::hidden;
        continue;
      }
      view = {image, *pixel, slope};
      return Seen::seen;
    }
    return seen;
  }

  /// Where an image shows a point of the frame; nothing where it does not.
  std::optional<Eigen::Vector2d> pixel_of(std::uint32_t image, const Eigen::Vector3d& local) const;

 private:
  void rank(const Eigen::Vector3d& map);

  const OrientedImages& images_;
  double steepest_;
  std::vector<std::uint32_t> near_;
  std::vector<std::pair<double, std::uint32_t>> ranked_;
};

}  // namespace swath::calib
