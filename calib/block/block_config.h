// SPDX-License-Identifier: GPL-3.0-or-later
// What `swath block` adjusts: cameras, images, image points, control. Every convention is a key; none has a default where files differ.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "calib/block/block_adjust.h"
#include "core/config/option.h"
#include "io/images/image_file.h"

namespace swath::calib {

enum class BlockKind { block_adjust };
/// Angles of an image: of the body (roll, pitch, heading), or of the camera's axes on the grid (Rx(omega) Ry(phi) Rz(kappa), or Ry(phi)
/// Rx(omega) Rz(kappa)).
enum class ImageAngles { none, roll_pitch_heading, omega_phi_kappa, phi_omega_kappa };
enum class ImageNorth { grid, true_north };
enum class ImageValues { observed, start };
enum class ControlKind { xyz, xy, z };
enum class BlockControlUse { control, check };

/// Sigmas of a camera's values: "held", "free", or the sigma of an observed value.
struct CameraSigmas {
  std::string f = "held", x0 = "held", y0 = "held", k1 = "held", k2 = "held", k3 = "held", p1 = "held", p2 = "held", b1 = "held",
              b2 = "held", boresight = "held", antenna = "held";
};

template <class V>
void describe(CameraSigmas& s, V& v) {
  v.option("f", s.f, "\"held\", \"free\", or a sigma with its unit: \"0.01 mm\".");
  v.option("x0", s.x0, "The same of x0.");
  v.option("y0", s.y0, "The same of y0.");
  v.option("k1", s.k1, "\"held\", \"free\", or a sigma in the value's unit: \"1e-9\".");
  v.option("k2", s.k2, "The same of k2.");
  v.option("k3", s.k3, "The same of k3.");
  v.option("p1", s.p1, "The same of p1.");
  v.option("p2", s.p2, "The same of p2.");
  v.option("b1", s.b1, "The same of b1.");
  v.option("b2", s.b2, "The same of b2.");
  v.option("boresight", s.boresight, "\"held\", \"free\", or a sigma of each angle: \"0.1 deg\". Needs observed angles.");
  v.option("antenna", s.antenna, "\"held\", \"free\", or a sigma of each coordinate of antenna: \"2 cm\".");
}

struct CameraConfig {
  std::string name = "camera";
  core::Metres f{0.1}, x0{}, y0{};
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, p1 = 0.0, p2 = 0.0, b1 = 0.0, b2 = 0.0;
  CameraSigmas sigma;
  std::optional<DistortionAt> distortion;
  int columns = 0, rows = 0;
  std::optional<core::Metres> pixel;
  core::Radians mount{};
  std::array<core::Radians, 3> boresight{};
  std::array<core::Metres, 3> antenna{};
};

template <class V>
void describe(CameraConfig& c, V& v) {
  v.option("name", c.name, "Name.");
  v.option("f", c.f, core::above(0), "Principal distance.");
  v.option("x0", c.x0, "Principal point from the middle of the sensor, to the right.");
  v.option("y0", c.y0, "Principal point from the middle of the sensor, up.");
  v.option("k1", c.k1, "Radial distortion, measured less ideal, mm^-2.", "Brown1971");
  v.option("k2", c.k2, "The same, mm^-4.");
  v.option("k3", c.k3, "The same, mm^-6.");
  v.option("p1", c.p1, "Decentring distortion, mm^-1: p1 (r^2 + 2 x^2) + 2 p2 x y in x.");
  v.option("p2", c.p2, "The same in y, mm^-1.");
  v.option("b1", c.b1, "Scale of x against y: b1 x in x.");
  v.option("b2", c.b2, "Shear: b2 y in x.");
  v.table("sigma", c.sigma, "Which values are held, free, or observed.");
  v.option("distortion", c.distortion, "Point that the distortion is computed from; needed where there is or may be any.");
  v.option("columns", c.columns, core::within(0, 1e6), "Pixels across; needed for image points in pixels.");
  v.option("rows", c.rows, core::within(0, 1e6), "Pixels down; needed for image points in pixels.");
  v.option("pixel", c.pixel, core::above(0), "Side of a pixel; needed for image points in pixels.");
  v.option("mount", c.mount, "Angle from the direction of flight to the image's x axis, clockwise from above.");
  v.option("boresight", c.boresight, "Roll, pitch, heading of the camera in the body, beside mount.");
  v.option("antenna", c.antenna, "From the perspective centre to the point that stations are of; forward, right, down.");
}

/// The table of images.
struct ImagesConfig {
  std::filesystem::path file, correlation;
  std::string name = "name", strip = "strip", time = "time", camera = "camera", x = "x", y = "y", z = "z", sigma_h = "sigma_h",
              sigma_v = "sigma_v";
  ImageValues stations = ImageValues::observed;
  core::Metres sigma_station_h{0.1}, sigma_station_v{0.1};
  ImageAngles angles = ImageAngles::none;
  std::optional<ImageNorth> north;
  ImageValues angle_use = ImageValues::start;
  core::Radians sigma_angle{0.0001}, sigma_heading{0.0002};
};

template <class V>
void describe(ImagesConfig& i, V& v) {
  v.option("file", i.file, "Table of the images; empty: those of a format that has orientations.");
  v.option("correlation", i.correlation, "Covariances within and between images, for all sigmas here; as orientation.direct writes them.");
  v.option("name", i.name, "Column of the names, as the image points have them.");
  v.option("strip", i.strip, "Column of the strip's number.");
  v.option("time", i.time, "Column of the time of exposure, s, on any scale.");
  v.option("camera", i.camera, "Column of the camera's name, where the table has it.");
  v.option("x", i.x, "Column of the station's easting.");
  v.option("y", i.y, "Column of its northing.");
  v.option("z", i.z, "Column of its height.");
  v.option("sigma_h", i.sigma_h, "Column of the sigma of easting and of northing, m, where the table has it.");
  v.option("sigma_v", i.sigma_v, "Column of the sigma of height, m, where the table has it.");
  v.option("stations", i.stations, "observed: GNSS stations that take part; start: values to start from.");
  v.option("sigma_station_h", i.sigma_station_h, core::above(0), "Sigma of easting and of northing where the table has none.");
  v.option("sigma_station_v", i.sigma_station_v, core::above(0), "Sigma of height where the table has none.");
  v.option("angles", i.angles, "Columns of angles, deg: roll pitch heading of the body, or omega phi kappa of the camera.");
  v.option("north", i.north, "What heading or kappa counts from: north of the grid or true north. Needed with angles.");
  v.option("angle_use", i.angle_use, "observed: the angles take part; start: values to start from.");
  v.option("sigma_angle", i.sigma_angle, core::above(0), "Sigma of observed roll and pitch (omega and phi).");
  v.option("sigma_heading", i.sigma_heading, core::above(0), "Sigma of observed heading (kappa).");
  v.check(i.angles == ImageAngles::none || i.north, "angles are given: state north = \"grid\" or \"true\"");
  v.check(i.angles != ImageAngles::none || i.angle_use == ImageValues::start, "angle_use is observed: state the kind of angles");
  v.check(i.correlation.empty() || (!i.file.empty() && (i.stations == ImageValues::observed || i.angle_use == ImageValues::observed)),
          "correlation has no effect: neither stations nor angles of a table are observed");
}

/// One file of control points.
struct BlockControlFile {
  std::filesystem::path file;
  ControlKind kind = ControlKind::xyz;
  BlockControlUse use = BlockControlUse::control;
  std::string name = "name", x = "x", y = "y", z = "z", sigma_h = "sigma_h", sigma_v = "sigma_v";
  core::Metres sigma_horizontal{0.02}, sigma_vertical{0.02};
};

template <class V>
void describe(BlockControlFile& c, V& v) {
  v.option("file", c.file, "Table of points, relative to the config.");
  v.option("kind", c.kind, "Coordinates that are surveyed; those that are not are approximate, to some metres.");
  v.option("use", c.use, "control: takes part in the adjustment; check: is compared with its result alone.");
  v.option("name", c.name, "Column of the names, as the image points have them.");
  v.option("x", c.x, "Column of eastings.");
  v.option("y", c.y, "Column of northings.");
  v.option("z", c.z, "Column of heights.");
  v.option("sigma_h", c.sigma_h, "Column of sigmas of easting and of northing, m, where the table has it.");
  v.option("sigma_v", c.sigma_v, "Column of sigmas of height, m, where the table has it.");
  v.option("sigma_horizontal", c.sigma_horizontal, core::above(0), "Sigma of easting and of northing where the table has none.");
  v.option("sigma_vertical", c.sigma_vertical, core::above(0), "Sigma of height where the table has none.");
}

struct BlockConfig {
  BlockKind kind = BlockKind::block_adjust;
  std::string crs;
  DriftSets drift = DriftSets::none;
  Datum datum = Datum::none;
  std::vector<CameraConfig> cameras;
  ImagesConfig images;
  std::vector<io::ImageFile> image_points;
  std::vector<BlockControlFile> control;
  BlockOptions adjust;
};

template <class V>
void describe(BlockConfig& b, V& v) {
  v.option("kind", b.kind, "What the file is.");
  v.option("crs", b.crs, "CRS of stations, control and products, or \"local\": a Cartesian frame, z up, m.");
  v.option("drift", b.drift, "Unknown shift and drift of the stations: none, one set for the block, or one per strip.", "Ackermann, eq 1");
  v.option("datum", b.datum, "Unknown datum of stations and angles against control: none, a shift, or with rotation and scale.");
  v.tables("camera", b.cameras, "Cameras.");
  v.table("images", b.images, "Images with stations and angles.");
  v.tables("image_points", b.image_points, "Files of image points.");
  v.tables("control", b.control, "Control and check points.");
  v.table("adjust", b.adjust, "Weights.");
  v.check(!b.crs.empty(), "crs is not stated: a CRS such as \"EPSG:25832+ellipsoidal\", or \"local\"");
  v.check(!b.image_points.empty(), "no [[image_points]]");
  v.check(b.datum == Datum::none || b.drift == DriftSets::none,
          "datum and drift are both stated: the shift of a drift is that of the datum; state datum = \"none\"");
}

/// Reads a config; paths in it become relative to where the program runs. Throws core::Error with all faults. `sets`: "key=value".
BlockConfig read_block_config(const std::filesystem::path& file, const core::Value& given);

/// The camera of a config as the adjustment takes it. Throws core::Error for a sigma that is none of "held", "free" and a number.
BlockCamera camera_of(const CameraConfig& config, const std::string& file);

}  // namespace swath::calib

namespace swath::core {
template <>
struct Choices<calib::BlockKind> {
  static constexpr std::array<std::string_view, 1> names{"block_adjust"};
};
template <>
struct Choices<calib::ImageAngles> {
  static constexpr std::array<std::string_view, 4> names{"none", "roll_pitch_heading", "omega_phi_kappa", "phi_omega_kappa"};
};
template <>
struct Choices<calib::ImageNorth> {
  static constexpr std::array<std::string_view, 2> names{"grid", "true"};
};
template <>
struct Choices<calib::ImageValues> {
  static constexpr std::array<std::string_view, 2> names{"observed", "start"};
};
template <>
struct Choices<calib::ControlKind> {
  static constexpr std::array<std::string_view, 3> names{"xyz", "xy", "z"};
};
template <>
struct Choices<calib::BlockControlUse> {
  static constexpr std::array<std::string_view, 2> names{"control", "check"};
};
}  // namespace swath::core
