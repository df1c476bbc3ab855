// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_reading.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "calib/block/block_start.h"
#include "calib/block/mark_plane.h"
#include "calib/block/navigation/navigation_chain.h"
#include "calib/block/orientation_table.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/printable.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Numbers = std::unordered_map<std::string, std::uint32_t>;

void refuse_same_cameras(const BlockConfig& c, const std::string& place) {
  for (size_t k = 1; k < c.cameras.size(); ++k)
    for (size_t other = 0; other < k; ++other)
      if (c.cameras[k].name == c.cameras[other].name)
        throw core::usage_error("two [[camera]] have the name " + c.cameras[k].name, place, "give each camera a name of its own");
}

/// The camera of an image that no table of images has.
std::uint32_t camera_of_file(const BlockConfig& config, const io::ImageData& data, size_t image) {
  if (config.cameras.size() == 1) return 0;
  if (data.camera_of.empty())
    throw core::Error("several cameras, and the file does not say which took image " + data.images[image], data.file.string(),
                      "add [images] with a table that has a column of the camera");
  return camera_number(config, data.cameras[data.camera_of[image]].name, data.file.string());
}

/// Pixels are those of the images as the other program had them: resized or turned ones would be taken for others.
void expect_same_size(const io::ImageData& data, size_t image, const CameraConfig& camera) {
  if (data.camera_of.empty() || camera.columns <= 0 || camera.rows <= 0) return;  // without pixels on_plane() refuses
  const io::FileCamera& file = data.cameras[data.camera_of[image]];
  const auto size = [](int columns, int rows) { return std::to_string(columns) + " x " + std::to_string(rows) + " pixels"; };
  if (file.columns != camera.columns || file.rows != camera.rows)
    throw core::Error("image " + data.images[image] + " has " + size(file.columns, file.rows) + " in this file, camera " + camera.name +
                          " has " + size(camera.columns, camera.rows),
                      data.file.string(),
                      "state columns, rows and pixel of the images as that program had them: it may have resized or turned them");
}

/// How a name may be meant that is nowhere: without folder and extension, in lower case.
std::string bare_name(std::string name) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return core::lower_case(std::filesystem::path(name).stem().string());
}

[[noreturn]] void refuse_unknown_image(const BlockConfig& config, const io::ImageData& data, const std::string& name,
                                       const std::vector<BlockImage>& images) {
  std::string hint =
      config.images.lacks_hint.empty() ? "add it to " + config.images.file.string() + ", or take its points out" : config.images.lacks_hint;
  for (const BlockImage& i : images)
    if (bare_name(i.name) == bare_name(name)) {
      const std::string same = "there is an image " + i.name + ": the names must be the same, with folder, extension, upper and lower case";
      // One that has image points of its own may be another image.
      const bool is_other = std::find(data.images.begin(), data.images.end(), i.name) != data.images.end();
      hint = is_other ? hint + "; or " + same : same;
      break;
    }
  throw core::Error("image " + name + " has image points and " + config.images.lacks, data.file.string(), hint);
}

/// Points of one file: numbers of images and points are those of the block. `prefix`: for points that have the program's own numbers.
void add_marks(const BlockConfig& config, const io::ImageFile& file, const io::ImageData& data, bool has_table, const std::string& prefix,
               ReadBlock& read, Numbers& image_number, Numbers& point_number) {
  ImageBlock& block = read.block;
  std::vector<std::uint32_t> image_of;
  for (size_t i = 0; i < data.images.size(); ++i) {
    const auto found = image_number.find(data.images[i]);
    if (found != image_number.end()) {
      image_of.push_back(found->second);
      continue;
    }
    if (has_table) refuse_unknown_image(config, data, data.images[i], block.images);
    BlockImage image;
    image.name = data.images[i];
    image.time = static_cast<double>(block.images.size());
    image.camera = camera_of_file(config, data, i);
    image_of.push_back(static_cast<std::uint32_t>(block.images.size()));
    image_number[image.name] = image_of.back();
    block.images.push_back(image);
  }
  for (size_t i = 0; i < image_of.size(); ++i) expect_same_size(data, i, config.cameras[block.images[image_of[i]].camera]);
  std::vector<std::uint32_t> point_of;
  for (size_t p = 0; p < data.points.size(); ++p) {
    const std::string name = (data.numbered.empty() || !data.numbered[p] ? "" : prefix) + data.points[p];
    const auto [it, is_new] = point_number.try_emplace(name, static_cast<std::uint32_t>(block.points.size()));
    if (is_new) block.points.push_back({name, Vector3d::Zero()});
    point_of.push_back(it->second);
  }
  for (const io::ImageMark& m : data.marks) {
    const std::uint32_t image = image_of[m.image];
    const CameraConfig& camera = config.cameras[block.images[image].camera];
    const Eigen::Vector2d p = on_plane(data, m, camera);
    const double sigma = file.sigma ? 1e3 * file.sigma->value : *file.sigma_pixels * 1e3 * pixel_side(camera, data.file.string());
    block.rays.push_back({image, point_of[m.point], p.x(), p.y(), sigma});
  }
}

void refuse_twice(const ImageBlock& block) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
  keys.reserve(block.rays.size());
  for (std::uint32_t r = 0; r < block.rays.size(); ++r)
    keys.emplace_back(static_cast<std::uint64_t>(block.rays[r].image) << 32 | block.rays[r].point, r);
  std::sort(keys.begin(), keys.end());
  size_t twice = 0;
  std::string first;
  for (size_t k = 1; k < keys.size(); ++k) {
    if (keys[k].first != keys[k - 1].first) continue;
    if (twice++ == 0)
      first = "point " + block.points[block.rays[keys[k].second].point].name + " on image " +
              block.images[block.rays[keys[k].second].image].name;
  }
  if (twice)
    throw core::Error("measured twice: " + first + (twice > 1 ? " and " + std::to_string(twice - 1) + " more" : ""), "",
                      "two points may have one name, or a file may be listed twice");
}

void add_control(const std::vector<SurveyedPoint>& points, const Numbers& point_number, ReadBlock& read) {
  std::unordered_map<std::string, std::string> known;
  for (const SurveyedPoint& p : points) {
    const auto found = point_number.find(p.name);
    if (found == point_number.end()) {
      read.control_without_image.push_back(p.name);
      continue;
    }
    if (!p.map.allFinite())
      throw core::Error("control point " + p.name + " is on an image and has no coordinates", p.place, "survey it, or take its line out");
    const auto [it, is_new] = known.try_emplace(p.name, p.place);
    if (!is_new) throw core::Error("control point " + p.name + " is there twice, first in " + it->second, p.place);
    BlockControl c;
    c.point = found->second;
    c.check = p.check;
    c.known = {p.kind != io::ControlKind::z, p.kind != io::ControlKind::z, p.kind != io::ControlKind::xy};
    c.sigma = {p.sigma_h, p.sigma_h, p.sigma_v};
    read.block.control.push_back(c);
    read.control.push_back({p.map, p.place});
  }
}

std::string first_of(const std::vector<std::string>& names) {
  std::string out;
  for (size_t k = 0; k < names.size() && k < 5; ++k) out += (k ? ", " : "") + names[k];
  return names.size() > 5 ? out + " and " + std::to_string(names.size() - 5) + " more" : out;
}

/// Camera positions of a file of orientations onto those of the block, where they are not all in a line.
std::optional<Eigen::Matrix4d> similarity(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) {
  if (from.size() < 3) return {};
  Eigen::Matrix3Xd a(3, from.size()), b(3, to.size());
  for (size_t k = 0; k < from.size(); ++k) {
    a.col(static_cast<Eigen::Index>(k)) = from[k];
    b.col(static_cast<Eigen::Index>(k)) = to[k];
  }
  constexpr double flat = 0.02;  // second against first extent
  const Eigen::Matrix3Xd centred = b.colwise() - b.rowwise().mean();
  const Vector3d extents = Eigen::JacobiSVD<Eigen::Matrix3Xd>(centred).singularValues();
  if (extents[1] < flat * extents[0]) return {};
  return Eigen::umeyama(a, b, true);
}

/// Start values by orientations of a file; false where they cannot be placed.
bool start_from_file(ReadBlock& read, const std::vector<std::pair<std::uint32_t, io::FilePose>>& poses, bool has_table) {
  std::vector<char> placed(read.block.images.size(), 0);
  for (const auto& [image, pose] : poses) placed[image] = 1;
  if (std::count(placed.begin(), placed.end(), 0) > 0) return false;
  Eigen::Matrix4d S = Eigen::Matrix4d::Identity();
  if (has_table) {
    std::vector<Vector3d> from, to;
    for (const auto& [image, pose] : poses) {
      from.push_back(pose.position);
      to.push_back(read.block.images[image].position);
    }
    const auto found = similarity(from, to);
    if (!found) return false;
    S = *found;
  }
  const double scale = std::cbrt(S.topLeftCorner<3, 3>().determinant());
  const Matrix3d R = S.topLeftCorner<3, 3>() / scale;
  for (const auto& [image, pose] : poses) {
    read.block.images[image].camera_R_local = pose.camera_R_frame * R.transpose();
    read.block.images[image].position = (S * pose.position.homogeneous()).head<3>();
  }
  return true;
}

void add_stations(const BlockConfig& config, const std::string& config_file, const std::vector<ImageRow>& rows, ReadBlock& read) {
  for (std::uint32_t i = 0; i < rows.size(); ++i) {
    read.block.images[i].position = read.frame.local_of(rows[i].map);
    if (config.images.angles != ImageAngles::none) read.angles.push_back({i, rows[i].angles});
    if (config.images.stations != ImageValues::observed) continue;
    Matrix3d covariance = Vector3d(rows[i].sigma_h, rows[i].sigma_h, rows[i].sigma_v).cwiseAbs2().asDiagonal();
    if (!read.covariance.empty()) covariance = read.covariance[i].topLeftCorner<3, 3>();
    const Matrix3d R = read.frame.local_R_grid(read.block.images[i].position);
    read.block.stations.push_back({i, read.block.images[i].position, R * covariance * R.transpose()});
    ++read.stations_observed;
  }
  if (config.drift != DriftSets::none && read.stations_observed == 0)
    throw core::usage_error("drift has no effect: no station is observed", config_file,
                            "state stations = \"observed\" and the file of [images], or drift = \"none\"");
}

std::vector<PoseCovariance> own_covariances(const OrientationCorrelation& correlation, const Numbers& image_number, size_t images) {
  std::vector<PoseCovariance> out(images, PoseCovariance::Identity());
  for (const CovariancePair& p : correlation.pairs)
    if (const auto found = image_number.find(correlation.images[p.image]); p.image == p.other && found != image_number.end())
      out[found->second] = p.value;
  return out;
}

/// From the grid and the body's axes to the local frame and the camera's.
void add_chain(const BlockConfig& config, const OrientationCorrelation& correlation, const Numbers& image_number, ReadBlock& read) {
  std::vector<PoseCovariance> turn(read.block.images.size(), PoseCovariance::Zero());
  for (size_t i = 0; i < turn.size(); ++i) {
    const BlockImage& image = read.block.images[i];
    turn[i].topLeftCorner<3, 3>() = read.frame.local_R_grid(image.position);
    turn[i].bottomRightCorner<3, 3>() = read.block.cameras[image.camera].body_R_camera.transpose();
  }
  const bool stations = config.images.stations == ImageValues::observed, angles = config.images.angle_use == ImageValues::observed;
  if (!stations && !angles) return;  // values to start from
  const ChainParts parts = stations && angles ? ChainParts{0, 6} : stations ? ChainParts{0, 3} : ChainParts{3, 3};
  read.block.chain = navigation_chain(correlation, image_number, turn, parts, config.images.correlation.string());
}

constexpr const char* names_may_differ = "names in the control file and of the image points may differ";

std::string unseen_control(const ReadBlock& read) {
  return "no control point is measured on an image: " + first_of(read.control_without_image);
}

/// Before anything is adjusted: what its normal equations would say without names.
void expect_datum(const ReadBlock& read, const std::string& config_file) {
  if (read.block.datum == Datum::none) return;
  if (read.stations_observed == 0)
    throw core::usage_error("datum has no effect: no station is observed", config_file, "state datum = \"none\"");
  std::array<size_t, 3> known{};
  for (const BlockControl& c : read.block.control)
    for (size_t k = 0; k < 3; ++k) known[k] += !c.check && c.known[k];
  const bool shift = read.block.datum == Datum::shift;
  const size_t plan = shift ? 1 : 2, heights = shift ? 1 : 3;
  if (known[0] >= plan && known[2] >= heights) return;
  const bool is_unseen = read.block.control.empty() && !read.control_without_image.empty();
  throw core::Error("the datum of the stations is not determinable: control has " + core::counted(known[0], "point") + " in plan and " +
                        core::counted(known[2], "height") + ", and " + std::string(core::Choices<Datum>::names.at(shift ? 1 : 2)) +
                        " needs " + std::to_string(plan) + " and " + std::to_string(heights),
                    config_file,
                    is_unseen ? unseen_control(read) + "; " + names_may_differ
                              : "survey more control, or state datum = \"none\"" + std::string(shift ? "" : " or \"shift\""));
}

void expect_points(const BlockConfig& config, ReadBlock& read) {
  std::vector<char> seen(read.block.images.size(), 0);
  for (const ImageRay& r : read.block.rays) seen[r.image] = 1;
  for (size_t i = 0; i < seen.size(); ++i)
    if (!seen[i]) read.images_without_points.push_back(read.block.images[i].name);
  if (!read.images_without_points.empty() && config.images.angle_use != ImageValues::observed)
    throw core::Error("images without image points: " + first_of(read.images_without_points), place_of_images(config),
                      "names may differ (with and without .jpg); or take these images out of the table");
}

}  // namespace

Matrix3d body_attitude(const ReadBlock& read, std::uint32_t image, const std::array<double, 3>& a, ImageAngles kind, ImageNorth north) {
  const BlockImage& i = read.block.images[image];
  const Matrix3d local_R_enu = north == ImageNorth::grid ? read.frame.local_R_grid(i.position) : read.frame.local_R_true(i.position);
  if (kind == ImageAngles::roll_pitch_heading) {
    Matrix3d enu_R_ned;
    enu_R_ned << 0, 1, 0, 1, 0, 0, 0, 0, -1;
    return local_R_enu * enu_R_ned * core::matrix_of({a[0], a[1], a[2]});
  }
  const Matrix3d enu_R_camera = kind == ImageAngles::omega_phi_kappa
                                    ? matrix_of_omega_phi_kappa({a[0], a[1], a[2]})
                                    : Eigen::AngleAxisd(a[1], Vector3d::UnitY()) * matrix_of_omega_phi_kappa({a[0], 0.0, a[2]});
  return local_R_enu * enu_R_camera * read.block.cameras[i.camera].body_R_camera.transpose();
}

void start_block(ReadBlock& read, const BlockConfig& config) {
  ImageBlock& block = read.block;
  block.attitudes.clear();
  const ImagesConfig& c = config.images;
  for (const StatedAngles& a : read.angles) {
    Matrix3d covariance = std::pow(c.sigma_angle.value, 2) * Matrix3d::Identity();
    covariance(2, 2) = std::pow(c.sigma_heading.value, 2);
    if (!read.covariance.empty()) covariance = read.covariance[a.image].bottomRightCorner<3, 3>();
    block.attitudes.push_back({a.image, body_attitude(read, a.image, a.value, c.angles, *c.north), covariance});
  }
  const std::vector<ImageStation> observed = block.stations;
  if (observed.empty())  // the table's positions, to start from
    for (std::uint32_t i = 0; i < block.images.size(); ++i) block.stations.push_back({i, block.images[i].position, Matrix3d::Identity()});
  start_poses(block);
  block.stations = observed;
  if (c.angle_use == ImageValues::start) block.attitudes.clear();
}

ReadBlock read_block(const BlockConfig& config, const std::string& config_file) {
  const std::vector<SurveyedPoint> control = read_control_tables(config);
  ReadBlock read = read_block(config, config_file, control);
  if (!control.empty() && read.block.control.empty())
    throw core::Error(unseen_control(read), config.control[0].file.string(), names_may_differ);
  return read;
}

ReadBlock read_block(const BlockConfig& config, const std::string& config_file, const std::vector<SurveyedPoint>& control) {
  ReadBlock read;
  if (config.cameras.empty()) throw core::usage_error("no [[camera]]", config_file);
  refuse_same_cameras(config, config_file);
  for (const CameraConfig& c : config.cameras) read.block.cameras.push_back(camera_of(c, config_file));
  read.block.drift_sets = config.drift;
  read.block.datum = config.datum;
  Numbers image_number, point_number;
  const bool has_table = !config.images.file.empty();
  std::vector<ImageRow> rows;
  if (has_table) rows = read_image_table(config);
  for (const ImageRow& r : rows) {
    image_number[r.image.name] = static_cast<std::uint32_t>(read.block.images.size());
    read.block.images.push_back(r.image);
  }
  std::vector<std::pair<std::uint32_t, io::FilePose>> poses;
  for (size_t k = 0; k < config.image_points.size(); ++k) {
    const io::ImageFile& f = config.image_points[k];
    const io::ImageData data = io::read_image_file(f);
    // Among several files a program's point 7 is not another's.
    const std::string prefix = config.image_points.size() > 1 ? std::to_string(k + 1) + ":" : "";
    add_marks(config, f, data, has_table, prefix, read, image_number, point_number);
    for (const io::FilePose& p : data.poses) poses.emplace_back(image_number.at(data.images[p.image]), p);
  }
  refuse_twice(read.block);
  add_control(control, point_number, read);
  expect_points(config, read);
  Vector3d middle = Vector3d::Zero();
  for (const ImageRow& r : rows) middle += r.map / static_cast<double>(rows.size());
  if (rows.empty() && config.crs != "local")
    throw core::usage_error("without a table of images the orientations' own frame is adjusted in", config_file, "state crs = \"local\"");
  read.frame = BlockFrame(config.crs, middle);
  OrientationCorrelation correlation;
  if (!config.images.correlation.empty()) {
    correlation = read_correlation(config.images.correlation);
    expect_grid(correlation, config.crs, config.images.correlation.string());
    read.covariance = own_covariances(correlation, image_number, read.block.images.size());
  }
  add_stations(config, config_file, rows, read);
  for (size_t k = 0; k < read.block.control.size(); ++k) read.block.control[k].position = read.frame.local_of(read.control[k].map);
  expect_datum(read, config_file);
  const bool by_file = config.images.angles == ImageAngles::none && start_from_file(read, poses, has_table);
  if (!by_file && !has_table)
    throw core::Error("nothing to start from: no table of images, and orientations of " + std::to_string(poses.size()) + " of " +
                          core::counted(read.block.images.size(), "image"),
                      config_file, "add [images] with a file of stations");
  if (!by_file) start_block(read, config);
  read.started_level = !by_file && config.images.angles == ImageAngles::none;
  read.started_from = by_file                                     ? "the orientations of the image points' file"
                      : config.images.angles != ImageAngles::none ? "stations and angles of the table"
                                                                  : "stations and the directions of the strips";
  if (!read.covariance.empty()) add_chain(config, correlation, image_number, read);
  intersect_points(read.block);
  return read;
}

}  // namespace swath::calib
