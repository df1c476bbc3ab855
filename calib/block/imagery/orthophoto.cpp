// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/orthophoto.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "calib/block/imagery/image_colours.h"
#include "calib/block/imagery/local_patch.h"
#include "calib/block/imagery/sight.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// A surface between the centres of its cells.
class Surface {
 public:
  explicit Surface(const core::Grid& grid) : grid_(grid), l_(grid.lattice) {}

  /// Nothing where the cell that holds the place has no height; neighbours without one drop out.
  std::optional<double> height(double x, double y) const {
    if (!cell(core::cell_index(x, l_.cell), core::cell_index(y, l_.cell))) return {};
    const double u = x / l_.cell - 0.5, v = y / l_.cell - 0.5;
    const std::int64_t i = core::floor_of(u), j = core::floor_of(v);
    double sum = 0.0, weights = 0.0;
    for (int dj = 0; dj < 2; ++dj)
      for (int di = 0; di < 2; ++di) {
        const auto at = cell(i + di, j + dj);
        if (!at) continue;
        const double a = u - static_cast<double>(i), b = v - static_cast<double>(j);
        const double w = (di == 0 ? 1.0 - a : a) * (dj == 0 ? 1.0 - b : b);
        sum += w * static_cast<double>(grid_.height[*at]), weights += w;
      }
    return weights > 0.0 ? std::optional(sum / weights) : std::nullopt;
  }
  /// Of the cell that holds the place, which has a height; 0 where the grid has no sigmas.
  double sigma(double x, double y) const {
    const auto at = cell(core::cell_index(x, l_.cell), core::cell_index(y, l_.cell));
    if (grid_.sigma.empty() || !at || !std::isfinite(grid_.sigma[*at])) return 0.0;
    return static_cast<double>(grid_.sigma[*at]);
  }

 private:
  std::optional<size_t> cell(std::int64_t i, std::int64_t j) const {
    i -= l_.i0, j -= l_.j0;
    if (i < 0 || j < 0 || i >= l_.nx || j >= l_.ny) return {};
    const size_t at = l_.at(static_cast<int>(i), static_cast<int>(j));
    return std::isfinite(grid_.height[at]) ? std::optional(at) : std::nullopt;
  }
  const core::Grid& grid_;
  const core::Lattice& l_;
};

struct Heights {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
};

Heights heights_of(const core::Grid& grid) {
  Heights out;
  for (const float h : grid.height)
    if (std::isfinite(h))
      out.lowest = std::min(out.lowest, static_cast<double>(h)), out.highest = std::max(out.highest, static_cast<double>(h));
  return out;
}

class Painter {
 public:
  Painter(const OrientedImages& images, const core::Grid& surface, const core::Lattice& own, const OrthoOptions& o, Orthophoto& out)
      : images_(images), surface_(surface), sight_(surface, o.reach.value), o_(o), heights_(heights_of(surface)), out_(out) {
    out_.lattice = own;
    out_.image.assign(own.size(), no_image);
    out_.sigma.assign(own.size(), unknown);
    out_.off_nadir.assign(own.size(), unknown);
    places_.resize(own.size());
  }

  void paint() {
    const core::Lattice& l = out_.lattice;
    const core::Box box{l.west(), l.south(), l.east(), l.north()};
    if (!(heights_.lowest <= heights_.highest)) {
      out_.counts.without_surface = l.size();
    } else {
      ImageChoice choice(images_, box, heights_.lowest, o_);
      const LocalPatch local(images_, box);
      for (int j = 0; j < l.ny; ++j)
        for (int i = 0; i < l.nx; ++i) look(l.centre_x(i), l.centre_y(j), l.at(i, j), choice, local);
    }
    const std::vector<Colour> colours = colours_of(images_, places_);
    for (std::vector<std::uint16_t>* band : {&out_.red, &out_.green, &out_.blue}) band->resize(colours.size());
    for (size_t k = 0; k < colours.size(); ++k) out_.red[k] = colours[k][0], out_.green[k] = colours[k][1], out_.blue[k] = colours[k][2];
  }

 private:
  void look(double x, double y, size_t at, ImageChoice& choice, const LocalPatch& local) {
    const auto z = surface_.height(x, y);
    if (!z) {
      ++out_.counts.without_surface;
      return;
    }
    const Vector3d map(x, y, *z), place = local(map);
    ImageView view;
    const Seen seen = choice.best(
        map, place, [&](const Vector3d& camera) { return sight_.is_hidden(map, camera, o_.clearance.value); }, view);
    if (seen != Seen::seen) {
      ++(seen == Seen::hidden ? out_.counts.hidden : out_.counts.outside);
      return;
    }
    ++out_.counts.seen;
    const OrientedImage& image = images_.images[view.image];
    const CameraConfig& camera = images_.configs[image.camera];
    const double distance = std::abs((image.camera_R_local * (place - image.local)).z());
    const double pixel = distance * 1e3 * camera.pixel->value / images_.cameras[image.camera].value[0];  // on the ground, m
    places_[at] = {view.image, static_cast<float>(view.pixel.x()), static_cast<float>(view.pixel.y()),
                   static_cast<float>(out_.lattice.cell / pixel)};
    out_.image[at] = view.image;
    out_.off_nadir[at] = static_cast<float>(std::atan(view.slope));
    if (image.has_covariance)
      out_.sigma[at] = static_cast<float>(std::sqrt(variance_in_plan(images_, view.image, place, surface_.sigma(x, y))));
  }

  const OrientedImages& images_;
  Surface surface_;
  Sight sight_;
  const OrthoOptions& o_;
  Heights heights_;
  Orthophoto& out_;
  std::vector<ImagePlace> places_;
};

}  // namespace

double variance_in_plan(const OrientedImages& images, std::uint32_t number, const Vector3d& local, double sigma_height) {
  const OrientedImage& image = images.images[number];
  const double f = images.cameras[image.camera].value[0];
  const Vector3d v = local - image.local, d = image.camera_R_local * v;
  const double x = -f * d.x() / d.z(), y = -f * d.y() / d.z(), r2 = x * x + y * y;  // mm, ideal
  // camera_R_local = exp(w) of the true one, and the measured place stays: what the camera's values add to it is taken off the direction
  // (x, y, -f), in the order of camera_keys. The place moves by J of all these errors, and along the ray v until it is back at its height.
  Eigen::Matrix<double, 3, camera_values> by_camera;
  by_camera << 0, -1, 0, -x * r2, -x * r2 * r2, -x * r2 * r2 * r2, -(r2 + 2 * x * x), -2 * x * y, -x, -y,  //
      0, 0, -1, -y * r2, -y * r2 * r2, -y * r2 * r2 * r2, -2 * x * y, -(r2 + 2 * y * y), 0, 0,             //
      -1, 0, 0, 0, 0, 0, 0, 0, 0, 0;
  Eigen::Matrix<double, 3, 6 + camera_values> J;
  J.leftCols<3>().setIdentity();
  J.middleCols<3>(3) = image.camera_R_local.transpose() * core::skew(d);
  J.rightCols<camera_values>() = (-d.z() / f) * image.camera_R_local.transpose() * by_camera;
  const Eigen::Vector2d along = v.head<2>() / v.z();
  const Eigen::Matrix<double, 2, 6 + camera_values> T = J.topRows<2>() - along * J.row(2);
  const auto of_pose = T.leftCols<6>();
  const auto of_camera = T.rightCols<camera_values>();
  const double variance = (of_pose * image.covariance * of_pose.transpose()).trace() +
                          2.0 * (of_pose * image.with_camera * of_camera.transpose()).trace() +
                          (of_camera * images.camera_covariance[image.camera] * of_camera.transpose()).trace();
  return std::max(0.0, variance) + along.squaredNorm() * sigma_height * sigma_height;
}

Orthophoto make_orthophoto(const OrientedImages& images, const core::Grid& surface, const core::Lattice& own, const OrthoOptions& o) {
  Orthophoto out;
  Painter(images, surface, own, o, out).paint();
  return out;
}

}  // namespace swath::calib
