// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/photos.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/geo/geodesy.h"
#include "core/grid.h"
#include "core/parallel.h"
#include "io/raster/geotiff.h"
#include "io/raster/image_raster.h"
#include "io/text/output_file.h"
#include "simulate/files/exposures.h"
#include "simulate/random.h"
#include "simulate/world/colours.h"
#include "simulate/world/map_ray.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t of_photos = std::uint64_t{1} << 44;
constexpr double least_seen = 0.05;  // least share of a ray that is seen

/// The colour of the first thing that a ray meets, water also where a laser would see none; black where it meets nothing.
std::array<std::uint8_t, 3> first_colour(const World& world, const Ray& ray, double far, std::int64_t seed, std::uint64_t number) {
  Random random = random_of(seed, Stream::camera, of_photos + number);
  Echoes echoes;
  world.trace(ray, far, 0.0, random, echoes);
  const Echo* seen = nullptr;
  for (int k = 0; k < echoes.count && !seen; ++k)
    if (echoes.echo[static_cast<size_t>(k)].energy > least_seen) seen = &echoes.echo[static_cast<size_t>(k)];
  if (seen) return colour_of(seen->kind, ray.at(seen->s), seed);
  double s = 0.0;
  if (!world.ground_hit(ray, far, s)) return {};
  const Eigen::Vector3d at = ray.at(s);
  return colour_of(world.relief().is_water(at.x(), at.y()) ? core::point_class::water : core::point_class::ground, at, seed);
}

class Darkroom {
 public:
  Darkroom(const World& world, const MapPatch& map, const Options& o) : world_(world), map_(map), o_(o) {}

  io::ImageRaster photograph(const CameraExposure& x) const {
    const CameraOptions& c = o_.camera;
    io::ImageRaster out{c.columns, c.rows, 3, 8, {}};
    out.values.resize(out.at(0, c.rows));
    const double side = 1e3 * c.pixel.value;  // mm
    const Vector3d tangent = map_.tangent_of(x.centre);
    core::in_parallel(static_cast<size_t>(c.rows), 16, [&](size_t begin, size_t end) {
      for (int row = static_cast<int>(begin); row < static_cast<int>(end); ++row)
        for (int column = 0; column < c.columns; ++column) {
          const Vector2d at((column + 0.5 - c.columns / 2.0) * side, (c.rows / 2.0 - row - 0.5) * side);
          const Vector3d slope = map_.direction_of(x.ecef_R_camera * seen_from(c, at).normalized());
          const auto ray = ray_down(map_, world_.relief(), tangent, slope);
          if (!ray) continue;
          const std::uint64_t number = (static_cast<std::uint64_t>(x.id) << 28) + static_cast<std::uint64_t>(row) * c.columns + column;
          const auto colour = first_colour(world_, ray->ray, ray->length, o_.seed, number);
          std::copy(colour.begin(), colour.end(), out.values.begin() + static_cast<std::ptrdiff_t>(out.at(column, row)));
        }
    });
    return out;
  }

  /// From straight above, over the area; cells of a pixel on the ground, or wider ones where these would be too many.
  void from_above(const std::filesystem::path& file) const {
    constexpr double most_cells = 4e6, step = 0.05;
    const double pixel = o_.camera.pixel.value / o_.camera.f.value * o_.flight.height.value;
    const double half = 0.5 * std::max(o_.world.length.value, o_.world.width.value);
    const double cell = step * std::ceil(std::max(pixel, 2.0 * half / std::sqrt(most_cells)) / step - 1e-9);
    const Vector3d middle = map_.map_origin();
    const core::Lattice l = core::lattice_of(cell, middle.x() - half, middle.y() - half, middle.x() + half, middle.y() + half);
    std::array<std::vector<std::uint16_t>, 3> bands;
    for (auto& band : bands) band.resize(l.size());
    const std::vector<std::uint8_t> is_there(l.size(), 1);
    const double top = world_.relief().highest() + 1.0, bottom = world_.relief().lowest() - 1.0;
    core::in_parallel(static_cast<size_t>(l.ny), 16, [&](size_t begin, size_t end) {
      for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
        for (int i = 0; i < l.nx; ++i) {
          const Ray ray{{l.centre_x(i) - middle.x(), l.centre_y(j) - middle.y(), top}, {0, 0, -1}, Vector3d::Zero()};
          const auto colour = first_colour(world_, ray, top - bottom, o_.seed, (std::uint64_t{1} << 40) + l.at(i, j));
          for (size_t k = 0; k < 3; ++k) bands[k][l.at(i, j)] = static_cast<std::uint16_t>(256 * colour[k]);
        }
    });
    io::write_colours(file, l, {bands.data(), &bands[1], &bands[2], &is_there}, 8, o_.crs);
  }

 private:
  const World& world_;
  const MapPatch& map_;
  const Options& o_;
};

/// East and north of the grid, and up, at a place.
Matrix3d ecef_R_grid(const core::Transform& to_map, const Vector3d& ecef) {
  constexpr double step = 10.0;  // m
  const core::Geodetic g = core::geodetic_of(ecef);
  const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
  const Vector3d way = to_map(ecef + step * ned.col(0)) - to_map(ecef);
  const double turn = std::atan2(way.x(), way.y());  // of true north on the grid, clockwise
  Matrix3d enu;
  enu << ned.col(1), ned.col(0), -ned.col(2);
  return enu * Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
}

void write_orientations(const std::filesystem::path& file, const std::vector<CameraExposure>& exposures, const Options& o) {
  const core::Transform to_map(core::wgs84_ecef(), core::Crs(o.crs));
  std::string table = "# crs: " + o.crs + "\nimage,camera,strip,x,y,z,omega,phi,kappa\n";
  for (const CameraExposure& x : exposures) {
    const Matrix3d R = ecef_R_grid(to_map, x.centre).transpose() * x.ecef_R_camera;
    const Vector3d at = to_map(x.centre);
    const double omega = std::atan2(-R(1, 2), R(2, 2)), phi = std::asin(std::clamp(R(0, 2), -1.0, 1.0)),
                 kappa = std::atan2(-R(0, 1), R(0, 0));
    std::array<char, 200> row;
    std::snprintf(row.data(), row.size(), "%d,camera,%d,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f\n", x.id, x.line, at.x(), at.y(), at.z(),
                  omega / core::degree, phi / core::degree, kappa / core::degree);
    table += row.data();
  }
  io::write_text_file(file, table);
}

void write_camera_values(const std::filesystem::path& file, const CameraOptions& c) {
  const auto length = [](core::Metres v) { return "\"" + core::format_quantity(core::Dimension::length, v.value) + "\""; };
  std::string text = "[[camera]]\nname = \"camera\"\nf = " + length(c.f) + "\nx0 = " + length(c.x0) + "\ny0 = " + length(c.y0);
  const std::pair<const char*, double> values[]{{"k1", c.k1}, {"k2", c.k2}, {"k3", c.k3}, {"p1", c.p1}, {"p2", c.p2}};
  for (const auto& [key, value] : values) text += std::string("\n") + key + " = " + core::format_number(value);
  text += "\ndistortion = \"ideal\"\ncolumns = " + std::to_string(c.columns) + "\nrows = " + std::to_string(c.rows) +
          "\npixel = " + length(c.pixel) + "\n";
  io::write_text_file(file, text);
}

}  // namespace

std::uint64_t write_photos(const std::filesystem::path& folder, const World& world, const MapPatch& map, const Flight& flight,
                           const Options& o) {
  const std::vector<CameraExposure> exposures = camera_exposures(flight, map, o);
  const Darkroom room(world, map, o);
  std::filesystem::create_directories(folder / "photos");
  for (const CameraExposure& x : exposures) io::write_image_raster(folder / "photos" / (std::to_string(x.id) + ".tif"), room.photograph(x));
  room.from_above(folder / "truth" / "orthophoto.tif");
  write_orientations(folder / "truth" / "orientation.csv", exposures, o);
  write_camera_values(folder / "truth" / "camera.toml", o.camera);
  return exposures.size();
}

}  // namespace swath::simulate
