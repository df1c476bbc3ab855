// SPDX-License-Identifier: GPL-3.0-or-later
// Photographs brought to the map over a surface, with the standard deviation of each cell's place.
#pragma once

#include <cstdint>
#include <vector>

#include "calib/block/imagery/image_choice.h"
#include "calib/block/imagery/oriented_images.h"
#include "core/config/result.h"
#include "core/grid.h"

namespace swath::calib {

struct OrthoOptions : SightOptions {
  OrthoOptions() { reach = core::Metres(100.0); }
  core::Metres cell{0.25};
};

template <class V>
void describe(OrthoOptions& o, V& v) {
  describe(static_cast<SightOptions&>(o), v);
  v.option("cell", o.cell, core::within(0.005, 100.0), "Side of the orthophoto's cells: about a pixel on the ground.");
}

struct OrthoCounts {
  std::uint64_t seen = 0, hidden = 0, outside = 0, without_surface = 0;
};

template <class V>
void describe(const OrthoCounts& r, V& v) {
  v.result("cells with a colour", r.seen, "Cells that a photograph shows.");
  v.result("cells hidden from all cameras", r.hidden, core::if_any(), "Cells behind higher ones on all photographs that would show them.");
  v.result("cells on no photograph", r.outside, core::if_any(), "Cells outside all photographs, or seen too obliquely.");
  v.result("cells without a surface", r.without_surface, core::if_any(), "Cells where the surface has no height.");
}

/// Columns on a lattice as core::Grid.
struct Orthophoto {
  core::Lattice lattice;
  std::vector<std::uint16_t> red, green, blue;  ///< over 16 bits
  std::vector<std::uint32_t> image;             ///< that the cell is from; no_image: none
  /// Radial standard deviation of the cell's place by the image's orientation and the surface's height, m; not a number where the image
  /// has no covariance. And the angle of its ray to the vertical, rad.
  std::vector<float> sigma, off_nadir;
  OrthoCounts counts;
};

/// `surface`: on the images' map, m, with what hides around the `own` cells. A cell without a height has no colour. A colour is the mean
/// over the cell. Throws core::Error as colours_of().
Orthophoto make_orthophoto(const OrientedImages& images, const core::Grid& surface, const core::Lattice& own, const OrthoOptions& o);

/// Variance in plan, m^2, of a place (in the frame) that an image shows, by the image's orientation, its camera's values and a sigma of the
/// place's height: the ray meets the surface elsewhere. Distortion itself moves the direction of a camera's errors by some per cent of
/// them, which is left out.
double variance_in_plan(const OrientedImages& images, std::uint32_t image, const Eigen::Vector3d& local, double sigma_height);

}  // namespace swath::calib
