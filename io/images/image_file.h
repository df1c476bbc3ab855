// SPDX-License-Identifier: GPL-3.0-or-later
// Image points as other programs measured them, and the cameras and orientations that stand beside them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/option.h"

namespace swath::io {

enum class ImageFormat { csv, bingo, patb, colmap, opensfm, blocks_exchange };
enum class ImageUnit { mm, um, pixel };
enum class ImageY { up, down };
/// The middle of the sensor; the outer corner of the first pixel (upper left); the centre of that pixel.
enum class ImageOrigin { middle, corner, pixel_centre };

/// One file of image points. What a format leaves open must be stated: nothing is guessed.
struct ImageFile {
  std::filesystem::path file;
  ImageFormat format = ImageFormat::csv;
  std::optional<ImageUnit> unit;
  std::optional<ImageY> y;
  std::optional<ImageOrigin> origin;
  std::optional<core::Metres> sigma;
  std::optional<double> sigma_pixels;
  std::string image_column = "image", point_column = "point", x_column = "x", y_column = "y";
};

template <class V>
void describe(ImageFile& f, V& v) {
  v.option("file", f.file, "Image points, relative to the config; colmap: the folder, opensfm: tracks.csv.");
  v.option("format", f.format, "Format; opensfm reads reconstruction.json beside tracks.csv.");
  v.option("unit", f.unit, "Unit of the coordinates. Needed for csv, bingo and patb; the other formats are in pixels.");
  v.option("y", f.y, "Sense of the y axis on the image. Needed for csv, bingo and patb.");
  v.option("origin", f.origin, "Where the coordinates count from: middle of the sensor, corner or centre of its first pixel.");
  v.option("sigma", f.sigma, core::above(0), "Sigma of an image coordinate on the sensor.");
  v.option("sigma_pixels", f.sigma_pixels, core::above(0), "The same in pixels.");
  v.option("image_column", f.image_column, "csv: column of the images' names.");
  v.option("point_column", f.point_column, "csv: column of the points' names.");
  v.option("x_column", f.x_column, "csv: column of x.");
  v.option("y_column", f.y_column, "csv: column of y.");
  v.check(!f.sigma || !f.sigma_pixels, "sigma and sigma_pixels are both given");
  v.check(f.sigma || f.sigma_pixels, "the sigma of the image points is not stated: add sigma = \"3 um\" or sigma_pixels = 0.3");
}

/// A measured point, as the file has it.
struct ImageMark {
  std::uint32_t image = 0, point = 0;  ///< numbers in ImageData
  double x = 0.0, y = 0.0;
  std::uint64_t line = 0;  ///< of the file; 0: not known
};

/// A camera as COLMAP, OpenSfM and BlocksExchange describe it: pixels, y down, distortion of the ideal point as in OpenCV.
struct FileCamera {
  std::string name;
  int columns = 0, rows = 0;
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< pixels; the principal point from the corner of the first pixel
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, p1 = 0.0, p2 = 0.0;
};

/// Camera axes: x right, y up, z from the scene to the camera.
struct FilePose {
  std::uint32_t image = 0;
  Eigen::Matrix3d camera_R_frame = Eigen::Matrix3d::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

struct ImageData {
  std::filesystem::path file;
  ImageUnit unit = ImageUnit::pixel;
  ImageY y = ImageY::down;
  ImageOrigin origin = ImageOrigin::corner;
  std::vector<std::string> images, points;
  /// Per point, 1: its name is a number of the program's own, which another file has for another point. Empty: names are the user's.
  std::vector<char> numbered;
  std::vector<ImageMark> marks;
  std::vector<FileCamera> cameras;
  std::vector<std::uint32_t> camera_of;  ///< per image; empty where the format names no camera
  std::vector<FilePose> poses;
};

/// A convention that a format leaves open and that is not stated, or that it fixes and that is stated.
struct ConventionFault {
  std::string key, what, hint;
};
std::vector<ConventionFault> convention_faults(const ImageFile& file);

/// True where coordinates or their sigma are in pixels or count from a corner: the camera must state columns, rows and pixel.
bool needs_pixels(const ImageFile& file);

/// Throws core::Error with file and line: a format that leaves something open and a config that does not state it; coordinates that are no
/// numbers; an image or a camera that is not there; a model of a camera that is not Brown's.
ImageData read_image_file(const ImageFile& file);

/// What is read of it, for hashes: of a COLMAP model and of OpenSfM several files.
std::vector<std::filesystem::path> files_of(const ImageFile& file);

/// By format, `file` as read_image_file() checked it.
ImageData read_image_csv(const ImageFile& file);
ImageData read_bingo(const ImageFile& file);
ImageData read_patb(const ImageFile& file);
ImageData read_colmap(const std::filesystem::path& folder);
ImageData read_opensfm(const std::filesystem::path& tracks);
ImageData read_blocks_exchange(const std::filesystem::path& file);

/// A point in the frame of the poses.
struct PlacedPoint {
  std::string name;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};
/// Writes cameras.txt, images.txt and points3D.txt: marks in pixels from the corner of the first pixel, y down. Points without marks are
/// left out. Poses: one per image of `data`, in its order.
void write_colmap(const std::filesystem::path& folder, const ImageData& data, const std::vector<PlacedPoint>& points);
/// Writes tracks.csv and reconstruction.json, of the same. Throws core::Error for a name with a tab.
void write_opensfm(const std::filesystem::path& folder, const ImageData& data, const std::vector<PlacedPoint>& points);

}  // namespace swath::io

namespace swath::core {
template <>
struct Choices<io::ImageFormat> {
  static constexpr std::array<std::string_view, 6> names{"csv", "bingo", "patb", "colmap", "opensfm", "blocks_exchange"};
};
template <>
struct Choices<io::ImageUnit> {
  static constexpr std::array<std::string_view, 3> names{"mm", "um", "pixel"};
};
template <>
struct Choices<io::ImageY> {
  static constexpr std::array<std::string_view, 2> names{"up", "down"};
};
template <>
struct Choices<io::ImageOrigin> {
  static constexpr std::array<std::string_view, 3> names{"middle", "corner", "pixel_centre"};
};
}  // namespace swath::core
