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
#include "core/config/option_visitors.h"
#include "io/images/image_file.h"
#include "io/survey/camera_file.h"
#include "io/survey/control_file.h"

namespace swath::calib {

enum class BlockKind { block_adjust };
/// Angles of an image: of the body (roll, pitch, heading), or of the camera's axes on the grid (Rx(omega) Ry(phi) Rz(kappa), or Ry(phi)
/// Rx(omega) Rz(kappa)).
enum class ImageAngles { none, roll_pitch_heading, omega_phi_kappa, phi_omega_kappa };
enum class ImageNorth { grid, true_north };
enum class ImageValues { observed, start };

struct CameraConfigSigmas : core::CameraSigmas {
  CameraConfigSigmas() = default;
  std::string antenna = "held";
};

template <class V>
void describe(CameraConfigSigmas& s, V& v) {
  describe(static_cast<core::CameraSigmas&>(s), v);
  v.option("antenna", s.antenna, "\"held\", \"free\", or a sigma of each coordinate of antenna: \"2 cm\".");
}

struct CameraConfig : core::FrameCamera {
  CameraConfig() = default;
  std::array<core::Metres, 3> antenna{};
  CameraConfigSigmas sigma;
  /// Of a camera of a survey, whose stations are its perspective centres by this lever arm: camera.toml is a table of survey.toml then.
  std::optional<io::SurveyCamera> of_survey{};
};

template <class V>
void describe(CameraConfig& c, V& v) {
  describe(static_cast<core::FrameCamera&>(c), v);
  v.option("antenna", c.antenna, "From the perspective centre to the point that stations are of; forward, right, down.");
  v.table("sigma", c.sigma, "Which values are held, free, or observed.");
}

/// The table of images.
struct ImagesConfig {
  /// In messages: the file for the user to look at where `file` is of a run's own, and what an image of the image points lacks that is
  /// not in it.
  std::string place{}, lacks = "is not in the table of images", lacks_hint{};
  /// Of a mistake of the angles, where these are a trajectory's; empty: the table's columns are corrected.
  std::string angles_hint{};
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
  io::ControlKind kind = io::ControlKind::xyz;
  io::ControlUse use = io::ControlUse::control;
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

/// Adds a fault for each [[camera]] whose principal distance is not stated: any default would be a guess.
void expect_distances(const core::Value& given, std::vector<core::Fault>& faults);

/// Reads a config; paths in it become relative to where the program runs. Throws core::Error with all faults. `sets`: "key=value".
BlockConfig read_block_config(const std::filesystem::path& file, const core::Value& given);

/// Where the user finds the images, for messages.
inline std::string place_of_images(const BlockConfig& c) { return c.images.place.empty() ? c.images.file.string() : c.images.place; }

/// body_R_camera of a mounting.
Eigen::Matrix3d camera_mounting(core::Radians mount, const std::array<core::Radians, 3>& boresight);

/// A camera of a survey: stations are its perspective centres by the stated lever arm, whose error is `antenna`.
CameraConfig config_of(const io::SurveyCamera& camera);

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
}  // namespace swath::core
