// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/image_colours.h"

#include <algorithm>
#include <cmath>

#include "calib/block/imagery/pixel_blend.h"
#include "io/raster/image_raster.h"

namespace swath::calib {
namespace {

constexpr double of_8_bits = 256.0;

/// A window of a photograph in memory.
struct Window {
  int column = 0, row = 0;
  io::ImageRaster raster;

  void add(double x, double y, std::array<double, 3>& sum) const {
    const PixelBlend blend(raster, x - column, y - row);
    for (size_t k = 0; k < 3; ++k) sum[k] += blend.of(raster.bands < 3 ? 0 : k);
  }
};

/// The mean over a square by as many bilinear values as it has pixels, those on a rim left out.
Colour colour_at(const Window& w, const ImagePlace& p, const OrientedImages& images) {
  constexpr int max_samples = 32;  // along a side
  const int n = std::clamp(static_cast<int>(std::lround(p.side)), 1, max_samples);
  const double side = p.side > 1.0f ? static_cast<double>(p.side) : 0.0;
  const std::uint32_t camera = images.images[p.image].camera;
  std::array<double, 3> sum{};
  int samples = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const double x = static_cast<double>(p.x) + ((i + 0.5) / n - 0.5) * side, y = static_cast<double>(p.y) + ((j + 0.5) / n - 0.5) * side;
      if (images.is_rim(camera, {x, y}, 1)) continue;
      w.add(x, y, sum);
      ++samples;
    }
  Colour out;
  const double scale = (w.raster.bits == 8 ? of_8_bits : 1.0) / std::max(1, samples);
  for (size_t k = 0; k < 3; ++k) out[k] = static_cast<std::uint16_t>(std::lround(std::min(sum[k] * scale, 65535.0)));
  return out;
}

Window window_of(const OrientedImages& images, const std::vector<ImagePlace>& places, const std::vector<std::uint32_t>& rows, size_t begin,
                 size_t end) {
  const OrientedImage& image = images.images[places[rows[begin]].image];
  const CameraConfig& camera = images.configs[image.camera];
  float x0 = 1e9f, y0 = 1e9f, x1 = 0.0f, y1 = 0.0f;
  for (size_t k = begin; k < end; ++k) {
    const ImagePlace& p = places[rows[k]];
    const float half = 0.5f * p.side + 1.0f;
    x0 = std::min(x0, p.x - half), x1 = std::max(x1, p.x + half), y0 = std::min(y0, p.y - half), y1 = std::max(y1, p.y + half);
  }
  Window out;
  out.column = std::clamp(static_cast<int>(std::floor(x0)), 0, camera.columns - 1);
  out.row = std::clamp(static_cast<int>(std::floor(y0)), 0, camera.rows - 1);
  const int right = std::clamp(static_cast<int>(std::ceil(x1)), out.column + 1, camera.columns),
            below = std::clamp(static_cast<int>(std::ceil(y1)), out.row + 1, camera.rows);
  out.raster = io::read_image_window(image.file, {out.column, out.row, right - out.column, below - out.row});
  return out;
}

}  // namespace

std::vector<Colour> colours_of(const OrientedImages& images, const std::vector<ImagePlace>& places) {
  std::vector<size_t> begin(images.images.size() + 1, 0);
  for (const ImagePlace& p : places)
    if (p.image != no_image) ++begin[p.image + 1];
  for (size_t i = 1; i < begin.size(); ++i) begin[i] += begin[i - 1];
  std::vector<std::uint32_t> rows(begin.back());
  std::vector<size_t> fill(begin.begin(), begin.end() - 1);
  for (size_t k = 0; k < places.size(); ++k)
    if (places[k].image != no_image) rows[fill[places[k].image]++] = static_cast<std::uint32_t>(k);
  std::vector<Colour> out(places.size(), Colour{});
  for (size_t i = 0; i < images.images.size(); ++i) {
    if (begin[i] == begin[i + 1]) continue;
    const Window window = window_of(images, places, rows, begin[i], begin[i + 1]);
    for (size_t k = begin[i]; k < begin[i + 1]; ++k) out[rows[k]] = colour_at(window, places[rows[k]], images);
  }
  return out;
}

}  // namespace swath::calib
