// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/imagery/oriented_images.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <numbers>
#include <set>

#include "calib/block/mark_plane.h"
#include "calib/block/orientation_table.h"
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
  constexpr std::string_view mark = "# ";
  std::ifstream in(file);
  std::string line, crs;
  while (crs.empty() && std::getline(in, line) && line.starts_with('#')) {
    if (line.ends_with('\r')) line.pop_back();
    if (line.starts_with(mark)) crs = crs_of_comment(line.substr(mark.size()));
  }
  return crs;
}

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// What lies beside photographs and is none.
bool is_beside(const fs::path& file) {
  static const std::set<std::string> endings{".xml", ".tfw", ".jgw", ".pgw",  ".jpgw", ".tifw", ".wld", ".ovr",
                                             ".xmp", ".txt", ".csv", ".json", ".prj",  ".md5",  ".toml"};
  return endings.contains(lower_case(file.extension().string()));
}

/// The files of a folder by name and by name without extension. Names' case does not matter where one file alone fits.
class Folder {
 public:
  explicit Folder(const fs::path& folder) {
    for (const fs::path& file : photographs_in(folder)) {
      by_name_[lower_case(file.filename().string())].push_back(file);
      by_stem_[lower_case(file.stem().string())].push_back(file);
    }
  }
  /// Empty where there is none. `image` may have a folder before its name, as some programs write it.
  fs::path file_of(const std::string& image, const std::string& place) const {
    const std::string name = lower_case(fs::path(image).filename().string());
    if (const auto at = by_name_.find(name); at != by_name_.end()) return only(at->second, image, place);
    if (const auto at = by_stem_.find(name); at != by_stem_.end()) return only(at->second, image, place);
    const bool has_extension = by_stem_.contains(lower_case(fs::path(name).stem().string())) && is_extension(fs::path(name).extension());
    return has_extension ? only(by_stem_.at(lower_case(fs::path(name).stem().string())), image, place) : fs::path();
  }

 private:
  /// ".jpg", not the ".1" of an image 12.1.
  static bool is_extension(const fs::path& ending) {
    const std::string text = ending.string();
    return text.size() > 2 && std::any_of(text.begin() + 1, text.end(), [](unsigned char c) { return std::isalpha(c) != 0; });
  }
  static fs::path only(const std::vector<fs::path>& files, const std::string& image, const std::string& place) {
    if (files.size() > 1)
      throw core::Error("two files may be image " + image + ": " + files[0].filename().string() + " and " + files[1].filename().string(),
                        place, "leave one of them in the folder, or name images with their extension");
    return files.front();
  }
  std::map<std::string, std::vector<fs::path>> by_name_, by_stem_;
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
    expect_all_or_none("r11 to r33", matrix_.size(), 9);
    expect_all_or_none("c11 to c66", covariance_.size(), 21);
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
    throw core::Error("camera " + table_.text(r, *camera_) + " is not in " + s.camera_place, place(r), "it lists " + names);
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
  void expect_all_or_none(const std::string& names, size_t there, size_t all) const {
    if (there != 0 && there != all)
      throw core::Error("only " + std::to_string(there) + " of the columns " + names + " are there", file_.string(),
                        "leave all of them out, or none");
  }
  Matrix3d rotation(size_t r) const {
    const Matrix3d by_angles = rotation_by_angles(r);
    if (matrix_.empty()) return by_angles;
    Matrix3d m;
    for (int k = 0; k < 9; ++k) m(k / 3, k % 3) = table_.number(r, matrix_[static_cast<size_t>(k)]);
    constexpr double rounding = 1e-5, closest = 0.5 * std::numbers::sqrt2;
    const std::string hint = "rows of grid_R_camera = Rx(omega) Ry(phi) Rz(kappa): camera x right, y up, z backward";
    if (!(m * m.transpose()).isIdentity(rounding) || m.determinant() < 0.0)
      throw core::Error("r11 to r33 are not a rotation matrix", place(r), hint);
    const double difference = closest * (m - by_angles).norm();  // rad, where it is small
    const std::string image_name = image(r);
    if (closest * (m.transpose() - by_angles).norm() < rounding && difference > rounding)
      throw core::Error("r11 to r33 of image " + image_name + " are the transpose of the rotation by omega, phi, kappa", place(r), hint);
    if (difference > rounding)
      throw core::Error("r11 to r33 and omega, phi, kappa of image " + image_name + " differ by " +
                            core::format_number(difference / core::degree, 3) + " deg",
                        place(r), hint);
    return m;
  }
  Matrix3d rotation_by_angles(size_t r) const {
    const auto angle = [&](size_t k) { return table_.number(r, angles_[k]) * core::degree; };
    return matrix_of_omega_phi_kappa({angle(0), angle(1), angle(2)});
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
                      file.string(), "state the CRS of the points, or orient the images on their map");
  }
  const core::Crs table(of_table), map(of_map);
  if ((table.heights() == core::Heights::unknown) == (map.heights() == core::Heights::unknown)) return;
  throw core::Error("heights of the orientations are: " + table.vertical_name() + ", those of the map: " + map.vertical_name(),
                    file.string(), "state both, with the height system: \"EPSG:25832+7837\" or \"EPSG:25832+ellipsoidal\"");
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
    const size_t images_before = out_.images.size();
    std::string crs = crs_of_table(s.orientation);
    if (crs.empty()) crs = s.crs.empty() ? out_.map.crs : s.crs;
    expect_one_height_system(crs, out_.map.crs, s.orientation);
    if (table.rows() == 0) throw core::Error("the table has no image", s.orientation.string());
    const auto first_camera = static_cast<std::uint32_t>(out_.cameras.size());
    const JointCovariance joint = joint_covariance_beside(s.orientation);
    for (const CameraConfig& c : s.cameras) {
      if (!c.pixel || c.columns <= 0 || c.rows <= 0)
        throw core::Error("camera " + c.name + " needs columns, rows and pixel to find places on photographs", s.camera_place,
                          "state them: columns = ..., rows = ..., pixel = \"5 um\"");
      const auto covariance = joint.cameras.find(c.name);
      out_.camera_covariance.push_back(covariance == joint.cameras.end() ? CameraCovariance::Zero() : covariance->second);
      out_.configs.push_back(c);
      out_.cameras.push_back(camera_of(c, s.camera_place));
    }
    if (out_.images.empty() && out_.without_file.empty()) start_frame(table.row(0).place, crs);
    const BlockFrame own(crs, origin_in(crs)), frame = out_.frame();
    for (size_t r = 0; r < table.rows(); ++r) {
      OrientedImage image;
      image.name = table.image(r);
      if (const auto [it, is_new] = known_.try_emplace(s.folder.string() + "\n" + image.name, table.place(r)); !is_new)
        throw core::Error("image " + image.name + " is listed twice, first in " + it->second, table.place(r));
      image.file = folder.file_of(image.name, table.place(r));
      if (image.file.empty()) {
        out_.without_file.push_back(image.name);
        continue;
      }
      image.camera = first_camera + table.camera(r, s);
      expect_size(image);
      if (const auto with = joint.images.find(image.name); with != joint.images.end()) image.with_camera = with->second;
      image.has_covariance = table.has_covariance();
      place(table.row(r), own, frame, image);
      out_.images.push_back(std::move(image));
    }
    const auto looks_up = [](const OrientedImage& i) { return i.camera_R_local(2, 2) < 0.0; };
    if (out_.images.size() > images_before &&
        std::all_of(out_.images.begin() + static_cast<std::ptrdiff_t>(images_before), out_.images.end(), looks_up))
      throw core::Error(
          "all cameras look up", s.orientation.string(),
          "omega, phi, kappa are of a camera with x to the right, y up and z backward; a level camera that looks down has 0, 0, 0");
  }

  OrientedImages take(const std::vector<PhotoSource>& sources) {
    std::erase_if(out_.without_file, [&](const std::string& name) {  // of a table that several folders share
      return std::any_of(out_.images.begin(), out_.images.end(), [&](const OrientedImage& i) { return i.name == name; });
    });
    if (out_.images.empty()) {
      const std::string first = out_.without_file.empty() ? "" : " (first: " + out_.without_file.front() + ")";
      throw core::Error(
          "no file in the folder matches an oriented image" + first, sources.front().folder.string(),
          "files are named as the column image of " + sources.front().orientation.string() + " has it, with or without extension");
    }
    find_rims();
    return std::move(out_);
  }

 private:
  void find_rims() {
    std::vector<std::vector<fs::path>> files(out_.cameras.size());
    for (const OrientedImage& i : out_.images) files[i.camera].push_back(i.file);
    for (const std::vector<fs::path>& of_camera : files) out_.rims.push_back(rim_of(of_camera));
  }
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
                        image.file.string(), "use the original images, neither rotated nor resized");
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

std::vector<fs::path> photographs_in(const fs::path& folder) {
  std::error_code ec;
  if (!fs::is_directory(folder, ec)) throw core::Error("there is no such folder of photographs", folder.string());
  std::vector<fs::path> out;
  for (const fs::directory_entry& e : fs::directory_iterator(folder, ec))
    if (e.is_regular_file(ec) && !is_beside(e.path()) && !e.path().filename().string().starts_with('.')) out.push_back(e.path());
  if (ec) io::throw_system_error("cannot read the folder", folder, ec.value());
  std::sort(out.begin(), out.end());
  return out;
}

OrientedImages read_oriented_images(const std::vector<PhotoSource>& sources, const MetreMap& map) {
  Reader reader(map);
  for (const PhotoSource& s : sources) reader.add(s);
  return reader.take(sources);
}

}  // namespace swath::calib
