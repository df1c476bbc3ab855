// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/oriented_images.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <set>

#include "calib/block/mark_plane.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/crs.h"
#include "io/raster/image_raster.h"
#include "io/text/output_file.h"
#include "io/text/text_table.h"

namespace swath::calib {
namespace {

namespace fs = std::filesystem;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// "# crs: EPSG:25832+7837; ..." above the table; empty where no comment says so.
std::string crs_of_table(const fs::path& file) {
  constexpr std::string_view key = "# crs: ";
  std::ifstream in(file);
  std::string line;
  while (std::getline(in, line) && line.starts_with('#'))
    if (line.starts_with(key)) {
      line = line.substr(key.size(), line.rfind("; omega phi kappa") - key.size());
      while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.pop_back();
      return line;
    }
  return {};
}

/// What lies beside photographs and is none.
bool is_beside(const fs::path& file) {
  static const std::set<std::string> endings{".xml", ".tfw", ".jgw", ".pgw",  ".jpgw", ".tifw", ".wld", ".ovr",
                                             ".xmp", ".txt", ".csv", ".json", ".prj",  ".md5",  ".toml"};
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return endings.contains(ending);
}

/// The files of a folder by name and by name without extension.
class Folder {
 public:
  explicit Folder(const fs::path& folder) : folder_(folder) {
    std::error_code ec;
    if (!fs::is_directory(folder, ec)) throw core::Error("there is no such folder of photographs", folder.string());
    for (const fs::directory_entry& e : fs::directory_iterator(folder, ec))
      if (e.is_regular_file(ec) && !is_beside(e.path())) by_stem_[e.path().stem().string()].push_back(e.path());
    if (ec) io::throw_system_error("cannot read the folder", folder, ec.value());
  }
  /// Empty where there is none.
  fs::path file_of(const std::string& image, const std::string& place) const {
    std::error_code ec;
    if (fs::is_regular_file(folder_ / image, ec)) return folder_ / image;
    for (const std::string& stem : {image, fs::path(image).stem().string()}) {
      const auto at = by_stem_.find(stem);
      if (at == by_stem_.end()) continue;
      if (at->second.size() > 1)
        throw core::Error(
            "two files may be image " + image + ": " + at->second[0].filename().string() + " and " + at->second[1].filename().string(),
            place, "leave one of them in the folder, or name images with their extension");
      return at->second.front();
    }
    return {};
  }

 private:
  fs::path folder_;
  std::map<std::string, std::vector<fs::path>> by_stem_;
};

/// What a table's columns say of an image, in its own CRS.
struct TableRow {
  Vector3d place;
  Matrix3d grid_R_camera;
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
};

class OrientationTable {
 public:
  explicit OrientationTable(const fs::path& file)
      : table_(file), image_(table_.column("image")), camera_(table_.column_if_there("camera", "camera")), file_(file) {
    for (const char* name : {"x", "y", "z"}) place_.push_back(table_.column(name));
    for (const char* name : {"omega", "phi", "kappa"}) angles_.push_back(table_.column(name));
    for (int r = 1; r <= 3; ++r)
      for (int c = 1; c <= 3; ++c) add_if_there("r", r, c, matrix_);
    for (int r = 1; r <= 6; ++r)
      for (int c = r; c <= 6; ++c) add_if_there("c", r, c, covariance_);
  }
  size_t rows() const { return table_.rows(); }
  bool has_covariance() const { return covariance_.size() == 21; }
  std::string place(size_t r) const { return table_.place(r); }
  const std::string& image(size_t r) const { return table_.name(r, image_, "the image"); }

  std::uint32_t camera(size_t r, const PhotoSource& s) const {
    if (!camera_) {
      if (s.cameras.size() == 1) return 0;
      throw core::Error("several cameras, and the table of orientations has no column \"camera\"", file_.string());
    }
    std::string names;
    for (size_t k = 0; k < s.cameras.size(); ++k) {
      if (s.cameras[k].name == table_.text(r, *camera_)) return static_cast<std::uint32_t>(k);
      names += (k > 0 ? ", " : "") + s.cameras[k].name;
    }
    throw core::Error("camera " + table_.text(r, *camera_) + " is not in " + s.camera_place, place(r), "that has " + names);
  }

  TableRow row(size_t r) const {
    TableRow out;
    for (int k = 0; k < 3; ++k) out.place[k] = table_.number(r, place_[static_cast<size_t>(k)]);
    out.grid_R_camera = rotation(r);
    if (!has_covariance()) return out;
    size_t at = 0;
    for (int i = 0; i < 6; ++i)
      for (int k = i; k < 6; ++k) out.covariance(i, k) = out.covariance(k, i) = table_.number(r, covariance_[at++]);
    return out;
  }

 private:
  void add_if_there(const char* letter, int r, int c, std::vector<size_t>& to) const {
    const std::string name = letter + std::to_string(r) + std::to_string(c);
    if (const auto column = table_.column_if_there(name, name)) to.push_back(*column);
  }
  Matrix3d rotation(size_t r) const {
    if (matrix_.size() == 9) {
      Matrix3d m;
      for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = table_.number(r, matrix_[static_cast<size_t>(k)]);
      constexpr double rounding = 1e-6;
      if (!(m * m.transpose()).isIdentity(rounding) || m.determinant() < 0.0)
        throw core::Error("r11 to r33 are no rotation", place(r), "rows of grid_R_camera: camera x right, y up, z backward");
      return m;
    }
    const auto about = [&](size_t k, const Vector3d& axis) { return Eigen::AngleAxisd(table_.number(r, angles_[k]) * core::degree, axis); };
    return (about(0, Vector3d::UnitX()) * about(1, Vector3d::UnitY()) * about(2, Vector3d::UnitZ())).toRotationMatrix();
  }

  io::TextTable table_;
  size_t image_;
  std::optional<size_t> camera_;
  fs::path file_;
  std::vector<size_t> place_, angles_, matrix_, covariance_;
};

/// A geoid's height between the two would move every image by tens of metres in silence.
void expect_one_height_system(const std::string& of_table, const std::string& of_map, const fs::path& file) {
  if (of_table == "local" || of_map == "local") {
    if (of_table == of_map) return;
    throw core::Error("orientations are in " + (of_table == "local" ? std::string("a local frame") : of_table) + ", the map is " +
                          (of_map == "local" ? "without a CRS" : "not"),
                      file.string(), "orient the images on the map of the points");
  }
  const core::Crs table(of_table), map(of_map);
  if ((table.heights() == core::Heights::unknown) == (map.heights() == core::Heights::unknown)) return;
  throw core::Error("heights of the orientations are: " + table.vertical_name() + ", those of the map: " + map.vertical_name(),
                    file.string(), "state both: \"EPSG:25832+7837\" or \"EPSG:25832+ellipsoidal\", for orientations by crs of [[photos]]");
}

JointCovariance joint_covariance_beside(const fs::path& table) {
  const fs::path file = table.parent_path() / joint_covariance_file;
  std::error_code ec;
  return fs::exists(file, ec) ? read_joint_covariance(file) : JointCovariance{};
}

/// Places images of one table after another.
class Reader {
 public:
  explicit Reader(const MetreMap& map) { out_.map = map; }

  void add(const PhotoSource& s) {
    const OrientationTable table(s.orientation);
    const Folder folder(s.folder);
    std::string crs = crs_of_table(s.orientation);
    if (crs.empty()) crs = s.crs.empty() ? out_.map.crs : s.crs;
    expect_one_height_system(crs, out_.map.crs, s.orientation);
    if (table.rows() == 0) throw core::Error("the table has no image", s.orientation.string());
    const auto first_camera = static_cast<std::uint32_t>(out_.cameras.size());
    const JointCovariance joint = joint_covariance_beside(s.orientation);
    for (const CameraConfig& c : s.cameras) {
      pixel_side(c, s.camera_place);
      const auto covariance = joint.cameras.find(c.name);
      out_.camera_covariance.push_back(covariance == joint.cameras.end() ? CameraCovariance::Zero() : covariance->second);
      out_.configs.push_back(c);
      out_.cameras.push_back(camera_of(c, s.camera_place));
    }
    if (out_.images.empty() && out_.without_file.empty()) start_frame(table.row(0).place, crs);
    out_.has_covariance = out_.has_covariance || table.has_covariance();
    const BlockFrame own(crs, origin_in(crs)), frame = out_.frame();
    for (size_t r = 0; r < table.rows(); ++r) {
      OrientedImage image;
      image.name = table.image(r);
      if (const auto [it, is_new] = known_.try_emplace(s.folder.string() + "\n" + image.name, table.place(r)); !is_new)
        throw core::Error("image " + image.name + " is there twice, first in " + it->second, table.place(r));
      image.file = folder.file_of(image.name, table.place(r));
      if (image.file.empty()) {
        out_.without_file.push_back(image.name);
        continue;
      }
      image.camera = first_camera + table.camera(r, s);
      expect_size(image);
      if (const auto with = joint.images.find(image.name); with != joint.images.end()) image.with_camera = with->second;
      place(table.row(r), own, frame, image);
      out_.images.push_back(std::move(image));
    }
  }

  OrientedImages take(const std::vector<PhotoSource>& sources) {
    if (out_.images.empty()) {
      const std::string which = out_.without_file.empty() ? "" : ", as " + out_.without_file.front() + ",";
      throw core::Error(
          "no oriented image" + which + " has a file of its name in the folder", sources.front().folder.string(),
          "files are named as the column image of " + sources.front().orientation.string() + " has it, with or without extension");
    }
    return std::move(out_);
  }

 private:
  /// The frame's middle: the first image, on the map.
  void start_frame(const Vector3d& place, const std::string& crs) {
    out_.middle = place;
    if (crs == "local") return;
    const core::Crs from(crs), to(out_.map.crs);
    if (from.key() != to.key()) out_.middle = core::Transform(from, to)(place);
  }
  Vector3d origin_in(const std::string& crs) const {
    if (crs == "local") return out_.middle;
    const core::Crs from(out_.map.crs), to(crs);
    return from.key() == to.key() ? out_.middle : core::Transform(from, to)(out_.middle);
  }
  void expect_size(const OrientedImage& image) {
    const CameraConfig& c = out_.configs[image.camera];
    const io::ImageRaster file = io::read_image_facts(image.file);
    const auto size = [](int columns, int rows) { return std::to_string(columns) + " x " + std::to_string(rows); };
    if (file.columns != c.columns || file.rows != c.rows)
      throw core::Error("the image has " + size(file.columns, file.rows) + " pixels, camera " + c.name + " has " + size(c.columns, c.rows),
                        image.file.string(), "the folder is to hold the images as the camera took them, not turned and not resized");
    out_.bits = std::max(out_.bits, file.bits);
  }
  void place(const TableRow& row, const BlockFrame& own, const BlockFrame& frame, OrientedImage& image) const {
    image.local = own.local_of(row.place);
    image.map = out_.map.in_metres(frame.map_of(image.local));
    const Matrix3d local_R_grid = own.local_R_grid(image.local);
    const Matrix3d local_R_camera = local_R_grid * row.grid_R_camera;
    image.camera_R_local = local_R_camera.transpose();
    Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Identity();
    turn.topLeftCorner<3, 3>() = local_R_grid;
    image.covariance = turn * row.covariance * turn.transpose();
    image.with_camera = turn * image.with_camera;
    const CameraConfig& c = out_.configs[image.camera];
    const BlockCamera& camera = out_.cameras[image.camera];
    constexpr double margin = 1.1;  // distortion and the principal point
    const double corner = margin * std::hypot(c.columns, c.rows) / 2.0 * 1e3 * c.pixel->value / camera.value[0];
    const double tilt = std::acos(std::clamp(local_R_camera(2, 2), -1.0, 1.0));  // the camera's z axis points back, up
    image.steepest = std::tan(std::min(tilt + std::atan(corner), 89.0 * core::degree));
  }

  OrientedImages out_;
  std::map<std::string, std::string> known_;
};

}  // namespace

OrientedImages read_oriented_images(const std::vector<PhotoSource>& sources, const MetreMap& map) {
  Reader reader(map);
  for (const PhotoSource& s : sources) reader.add(s);
  return reader.take(sources);
}

}  // namespace swath::calib
