// SPDX-License-Identifier: GPL-3.0-or-later
// Poses and points are taken through ECEF; the straight line between them on the map serves for visibility alone (2 cm off at 1 km).
#include "simulate/files/camera_files.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/text/output_file.h"
#include "io/text/toml_text.h"
#include "simulate/files/exposures.h"
#include "simulate/random.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double clear_of = 0.5;    // m: what is nearer to a point than this does not hide it
constexpr double hides = 0.5;       // share of a beam
constexpr double millimetre = 1e3;  // per metre
constexpr std::uint64_t of_images = 1, of_lines = std::uint64_t{1} << 40, of_marks = std::uint64_t{1} << 41,
                        of_control = std::uint64_t{1} << 42;

struct GroundPoint {
  std::string name;
  Vector3d on_map, ecef;  // on_map: as World
  std::uint32_t seen = 0;
};

struct Mark {
  std::uint32_t image, point;
  Vector2d at;  // mm
};

struct LineDrift {
  Vector3d shift, change;          // east, north, up, m
  double first = 0.0, last = 0.0;  // s
};

Vector3d vector_of(const std::array<core::Metres, 3>& v) { return {v[0].value, v[1].value, v[2].value}; }

template <class... Values>
void put_row(std::string& to, const char* form, Values... values) {
  std::array<char, 400> line;
  to.append(line.data(), static_cast<size_t>(std::snprintf(line.data(), line.size(), form, values...)));
}

class Photographer {
 public:
  Photographer(const World& world, const MapPatch& map, const Flight& flight, core::GpsTime start, const Options& o)
      : world_(world),
        map_(map),
        flight_(flight),
        start_(start),
        o_(o),
        c_(o.camera),
        to_map_(core::wgs84_ecef(), core::Crs(o.crs)),
        to_ecef_(core::Crs(o.crs), core::wgs84_ecef()) {}

  CameraMade write(const std::filesystem::path& folder) {
    expose();
    lay_points();
    for (std::uint32_t i = 0; i < exposures_.size(); ++i) photograph(i);
    if (marks_.empty()) throw core::usage_error("no image sees a point", "camera.file", "check camera.f, flight.height and the area");
    write_images(folder);
    write_marks(folder);
    write_control(folder);
    write_config(folder);
    CameraMade made{exposures_.size(), 0, 0, hidden_, has_seen(false), has_seen(true)};
    for (const GroundPoint& p : points_) made.points += p.seen > 1;
    for (const Mark& m : marks_) made.image_points += points_[m.point].seen > 1;
    return made;
  }

 private:
  Vector3d map_position(const Vector3d& ecef) const { return to_map_(ecef); }
  double noise(double sigma) const { return o_.noise.noise_free ? 0.0 : sigma; }

  void expose() {
    exposures_ = camera_exposures(flight_, map_, o_);
    for (const CameraExposure& x : exposures_) {
      LineDrift& d = drifts_.try_emplace(x.line, LineDrift{Vector3d::Zero(), Vector3d::Zero(), x.t, x.t}).first->second;
      d.first = std::min(d.first, x.t), d.last = std::max(d.last, x.t);
    }
    for (auto& [line, d] : drifts_) {
      Random random = random_of(o_.seed, Stream::camera, of_lines + static_cast<std::uint64_t>(line));
      for (int k = 0; k < 3; ++k) d.shift[k] = c_.shift.value * random.normal(), d.change[k] = c_.drift.value * random.normal();
    }
  }

  void add_point(const std::string& name, double e, double n) {
    const Vector3d at(e, n, world_.relief().height(e, n));
    points_.push_back({name, at, to_ecef_(Vector3d(at + Vector3d(map_.map_origin().x(), map_.map_origin().y(), 0.0)))});
  }

  /// Under the exposure that lies farthest along the first line's direction and across it, a little towards the middle: several images see
  /// it.
  Vector2d corner(double along, double across) const {
    constexpr double inwards = 0.1;
    Vector2d way = exposures_[0].on_map.head<2>(), middle = Vector2d::Zero();
    for (const CameraExposure& x : exposures_) {
      middle += x.on_map.head<2>() / static_cast<double>(exposures_.size());
      if (x.line == exposures_[0].line) way = x.on_map.head<2>();
    }
    way -= exposures_[0].on_map.head<2>();
    if (!(way.norm() > 0.0)) way = Vector2d::UnitX();
    const Vector2d u = way.normalized(), v(-u.y(), u.x());
    Vector2d reach = Vector2d::Constant(1e-9);
    for (const CameraExposure& x : exposures_) {
      const Vector2d d = x.on_map.head<2>() - middle;
      reach = reach.cwiseMax(Vector2d(std::abs(d.dot(u)), std::abs(d.dot(v))));
    }
    const auto share = [&](const CameraExposure& x) {
      const Vector2d d = x.on_map.head<2>() - middle;
      return along * d.dot(u) / reach.x() + across * d.dot(v) / reach.y();
    };
    const auto farthest = std::max_element(exposures_.begin(), exposures_.end(),
                                           [&](const CameraExposure& a, const CameraExposure& b) { return share(a) < share(b); });
    return (1.0 - inwards) * farthest->on_map.head<2>() + inwards * middle;
  }

  /// `across`: points from west to east and from south to north.
  void expect_few_points(const Vector2d& across) const {
    constexpr double most_points = 2e7;
    const double points = across.x() * across.y();
    if (points < most_points) return;
    std::array<char, 80> text;
    std::snprintf(text.data(), text.size(), "the flight would have %.0f million tie points", 1e-6 * points);
    throw core::usage_error(text.data(), "camera.points", "check camera.f and camera.pixel, or take fewer points");
  }

  /// Ground points about evenly where images may see them, as many as make `points` per image; control and check points.
  void lay_points() {
    if (exposures_.empty()) return;
    Vector2d low = exposures_[0].on_map.head<2>(), high = low;
    double height = 0.0;
    for (const CameraExposure& x : exposures_) {
      low = low.cwiseMin(x.on_map.head<2>()), high = high.cwiseMax(x.on_map.head<2>());
      height += (x.on_map.z() - o_.world.ground.value) / static_cast<double>(exposures_.size());
    }
    const double side = c_.pixel.value / c_.f.value * height, spacing = side * std::sqrt(double(c_.columns) * c_.rows / c_.points);
    const double rim = 0.5 * side * std::min(c_.columns, c_.rows);
    expect_few_points((high - low + Vector2d::Constant(2.0 * rim)) / spacing);
    Random random = random_of(o_.seed, Stream::camera, of_images);
    size_t k = 0;
    for (double e = low.x() - rim; e < high.x() + rim; e += spacing)
      for (double n = low.y() - rim; n < high.y() + rim; n += spacing) {
        const double shift_e = random.uniform(-0.3, 0.3), shift_n = random.uniform(-0.3, 0.3);
        add_point("t" + std::to_string(++k), e + spacing * shift_e, n + spacing * shift_n);
      }
    tie_points_ = points_.size();
    for (int c = 0; c < c_.control; ++c) {
      const double u = random.uniform(), w = random.uniform();
      const Vector2d at =
          c < 4 ? corner(c % 2 == 0 ? -1.0 : 1.0, c < 2 ? -1.0 : 1.0) : Vector2d(low + Vector2d(u, w).cwiseProduct(high - low));
      add_point("control" + std::to_string(c + 1), at.x(), at.y());
    }
    for (int c = 0; c < c_.check; ++c) {
      const double u = random.uniform(), w = random.uniform();
      add_point("check" + std::to_string(c + 1), low.x() + u * (high.x() - low.x()), low.y() + w * (high.y() - low.y()));
    }
    cell_ = std::max(1.0, 0.5 * side * std::max(c_.columns, c_.rows));
    for (std::uint32_t p = 0; p < points_.size(); ++p) cells_[cell_of(points_[p].on_map)].push_back(p);
  }

  std::pair<int, int> cell_of(const Vector3d& at) const {
    return {static_cast<int>(std::floor(at.x() / cell_)), static_cast<int>(std::floor(at.y() / cell_))};
  }

  bool is_hidden(const CameraExposure& x, const GroundPoint& p) const {
    const Vector3d way = p.on_map - x.on_map;
    const double length = way.norm();
    const Ray ray{x.on_map, way / length, Vector3d::Zero()};
    Random random = random_of(o_.seed, Stream::camera, of_marks + static_cast<std::uint64_t>(&p - points_.data()));
    Echoes echoes;
    world_.trace(ray, 1.1 * length, 0.0, random, echoes);
    for (int k = 0; k < echoes.count; ++k) {
      const Echo& e = echoes.echo[static_cast<size_t>(k)];
      if (e.s < length - clear_of && e.energy > 0.1 * hides) return true;
    }
    return false;
  }

  void photograph(std::uint32_t image) {
    const CameraExposure& x = exposures_[image];
    Random random = random_of(o_.seed, Stream::camera, of_marks / 2 + image);
    const auto [ce, cn] = cell_of(x.on_map);
    constexpr int around = 3;
    for (int e = ce - around; e <= ce + around; ++e)
      for (int n = cn - around; n <= cn + around; ++n) {
        const auto cell = cells_.find({e, n});
        if (cell == cells_.end()) continue;
        for (const std::uint32_t p : cell->second) {
          const auto at = seen_at(c_, x.ecef_R_camera.transpose() * (points_[p].ecef - x.centre));
          if (!at) continue;
          if (is_hidden(x, points_[p])) {
            ++hidden_;
            continue;
          }
          const double sigma = noise(c_.noise) * millimetre * c_.pixel.value, dx = random.normal(), dy = random.normal();
          marks_.push_back({image, p, *at + sigma * Vector2d(dx, dy)});
          ++points_[p].seen;
        }
      }
  }

  void write_images(const std::filesystem::path& folder) const {
    std::string table = "name,strip,time,x,y,z,roll,pitch,heading\n", truth = table,
                drift = "strip,shift_e,shift_n,shift_u,change_e,change_n,change_u\n";
    for (std::uint32_t i = 0; i < exposures_.size(); ++i) {
      const CameraExposure& x = exposures_[i];
      const LineDrift& d = drifts_.at(x.line);
      const double u = d.last > d.first ? (x.t - d.first) / (d.last - d.first) : 0.0, time = start_ + x.t;
      Random random = random_of(o_.seed, Stream::camera, of_images + 1 + i);
      const core::Geodetic g = core::geodetic_of(x.antenna);
      const Matrix3d ned = core::ecef_R_ned(g.latitude, g.longitude);
      const double h = noise(c_.station_horizontal.value), v = noise(c_.station_vertical.value);
      const double e1 = random.normal(), e2 = random.normal(), e3 = random.normal();
      const Vector3d enu = d.shift + u * d.change + Vector3d(h * e1, h * e2, v * e3);
      const Vector3d at = map_position(x.antenna + ned * Vector3d(enu.y(), enu.x(), -enu.z())), centre = map_position(x.centre);
      const double r1 = random.normal(), r2 = random.normal(), r3 = random.normal();
      const Vector3d turn(noise(c_.roll_pitch.value) * r1, noise(c_.roll_pitch.value) * r2, noise(c_.heading.value) * r3);
      const core::Attitude a = core::attitude_of(core::matrix_of(x.attitude) * core::exp_so3(turn));
      put_row(table, "%d,%d,%.9f,%.5f,%.5f,%.5f,%.9f,%.9f,%.9f\n", x.id, x.line, time, at.x(), at.y(), at.z(), a.roll / core::degree,
              a.pitch / core::degree, a.heading / core::degree);
      put_row(truth, "%d,%d,%.9f,%.6f,%.6f,%.6f,%.9f,%.9f,%.9f\n", x.id, x.line, time, centre.x(), centre.y(), centre.z(),
              x.attitude.roll / core::degree, x.attitude.pitch / core::degree, x.attitude.heading / core::degree);
    }
    for (const auto& [line, d] : drifts_)
      put_row(drift, "%d,%.6f,%.6f,%.6f,%.6f,%.6f,%.6f\n", line, d.shift.x(), d.shift.y(), d.shift.z(), d.change.x(), d.change.y(),
              d.change.z());
    io::write_text_file(folder / "images.csv", table);
    io::write_text_file(folder / "truth" / "images.csv", truth);
    io::write_text_file(folder / "truth" / "drift.csv", drift);
  }

  void write_marks(const std::filesystem::path& folder) const {
    std::string table = "image,point,x,y\n", truth = "name,x,y,z\n";
    const double side = millimetre * c_.pixel.value;
    for (const Mark& m : marks_) {
      if (points_[m.point].seen < 2) continue;
      put_row(table, "%d,%s,%.4f,%.4f\n", exposures_[m.image].id, points_[m.point].name.c_str(), m.at.x() / side + c_.columns / 2.0,
              c_.rows / 2.0 - m.at.y() / side);
    }
    for (const GroundPoint& p : points_)
      if (p.seen > 1)
        put_row(truth, "%s,%.6f,%.6f,%.6f\n", p.name.c_str(), p.on_map.x() + map_.map_origin().x(), p.on_map.y() + map_.map_origin().y(),
                p.on_map.z());
    io::write_text_file(folder / "image_points.csv", table);
    io::write_text_file(folder / "truth" / "camera_points.csv", truth);
  }

  bool has_seen(bool check) const {
    for (size_t p = tie_points_; p < points_.size(); ++p)
      if (points_[p].seen > 1 && points_[p].name.starts_with("check") == check) return true;
    return false;
  }

  void write_control(const std::filesystem::path& folder) const {
    for (const bool check : {false, true}) {
      std::string table = "name,x,y,z\n";
      for (size_t p = tie_points_; p < points_.size(); ++p) {
        const GroundPoint& g = points_[p];
        if (g.name.starts_with("check") != check || g.seen < 2) continue;
        Random random = random_of(o_.seed, Stream::camera, of_control + p);
        const double sigma = noise(c_.control_sigma.value), e = random.normal(), n = random.normal(), h = random.normal();
        put_row(table, "%s,%.5f,%.5f,%.5f\n", g.name.c_str(), g.on_map.x() + map_.map_origin().x() + sigma * e,
                g.on_map.y() + map_.map_origin().y() + sigma * n, g.on_map.z() + sigma * h);
      }
      if (has_seen(check)) io::write_text_file(folder / (check ? "block_check.csv" : "block_control.csv"), table);
    }
  }

  void write_config(const std::filesystem::path& folder) const {
    const auto length = [](double metres) { return "\"" + core::format_quantity(core::Dimension::length, metres) + "\""; };
    const auto angle = [](double radians) { return "\"" + core::format_quantity(core::Dimension::angle, radians) + "\""; };
    const auto no_less = [](double sigma, double least) { return std::max(sigma, least); };
    const Vector3d arm = vector_of(o_.mounting.lever_arm_antenna) - vector_of(c_.lever_arm);
    const bool drifts = c_.shift.value > 0.0 || c_.drift.value > 0.0;
    std::string text = "# Simulated images: swath block block.toml; truth/ holds what is known of them.\nkind = \"block_adjust\"\ncrs = " +
                       io::toml_scalar(o_.crs) + "\ndrift = \"" + (drifts ? "strip" : "none") +
                       "\"\n\n[images]\nfile = \"images.csv\"\nsigma_station_h = " + length(no_less(c_.station_horizontal.value, 1e-4)) +
                       "\nsigma_station_v = " + length(no_less(c_.station_vertical.value, 1e-4)) +
                       "\nangles = \"roll_pitch_heading\"\nnorth = \"true\"\nangle_use = \"observed\"\nsigma_angle = " +
                       angle(no_less(c_.roll_pitch.value, 1e-7)) + "\nsigma_heading = " + angle(no_less(c_.heading.value, 1e-7)) + "\n\n";
    text += "[[camera]]\nname = \"camera\"\nf = " + length(c_.nominal_f.value) + "\nk3 = " + core::format_number(c_.k3) +
            "\ndistortion = \"ideal\"\ncolumns = " + std::to_string(c_.columns) + "\nrows = " + std::to_string(c_.rows) +
            "\npixel = " + length(c_.pixel.value) + "\nmount = " + angle(c_.mount.value) + "\nantenna = [" + length(arm.x()) + ", " +
            length(arm.y()) + ", " + length(arm.z()) +
            "]\nsigma = { f = \"free\", x0 = \"free\", y0 = \"free\", k1 = \"free\", k2 = \"free\", p1 = \"free\", p2 = \"free\", "
            "boresight = \"free\" }\n\n[[image_points]]\nfile = \"image_points.csv\"\nunit = \"pixel\"\ny = \"down\"\norigin = "
            "\"corner\"\nsigma_pixels = " +
            core::format_number(no_less(c_.noise, 1e-3)) + "\n";
    const std::string sigma = length(no_less(c_.control_sigma.value, 1e-4));
    for (const bool check : {false, true})
      if (has_seen(check))
        text += std::string("\n[[control]]\nfile = \"") + (check ? "block_check.csv\"\nuse = \"check\"" : "block_control.csv\"") +
                "\nsigma_horizontal = " + sigma + "\nsigma_vertical = " + sigma + "\n";
    io::write_text_file(folder / "block.toml", text);
  }

  const World& world_;
  const MapPatch& map_;
  const Flight& flight_;
  core::GpsTime start_;
  const Options& o_;
  const CameraOptions& c_;
  core::Transform to_map_, to_ecef_;
  std::vector<CameraExposure> exposures_;
  std::vector<GroundPoint> points_;
  std::vector<Mark> marks_;
  std::map<int, LineDrift> drifts_;
  std::map<std::pair<int, int>, std::vector<std::uint32_t>> cells_;
  size_t tie_points_ = 0;
  std::uint64_t hidden_ = 0;
  double cell_ = 1.0;
};

}  // namespace

CameraMade write_camera(const std::filesystem::path& folder, const World& world, const MapPatch& map, const Flight& flight,
                        core::GpsTime start, const Options& options) {
  return Photographer(world, map, flight, start, options).write(folder);
}

}  // namespace swath::simulate
