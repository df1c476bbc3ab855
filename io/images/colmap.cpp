// SPDX-License-Identifier: GPL-3.0-or-later
// COLMAP's sparse model as text (its documentation, "Output Format" and "Camera Models"): cameras.txt, images.txt, points3D.txt. The
// quaternion and the translation take a point to the camera (x right, y down, z forward); pixels count from the outer corner of the upper
// left pixel. The image's own axes here are x right, y up, z backward: the second and third row change their sign.
#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "core/config/units.h"
#include "core/error.h"
#include "io/images/image_file.h"
#include "io/images/image_lines.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

const Eigen::Vector3d down_forward(1.0, -1.0, -1.0);

/// Which parameter of FileCamera each number of a model is; '-' must be 0.
struct ColmapModel {
  const char* name;
  std::vector<double FileCamera::*> values;
  size_t zeros = 0;        ///< numbers at the end that Brown's model does not have
  bool one_focal = false;  ///< the first number is both fx and fy
};

const std::vector<ColmapModel>& colmap_models() {
  using C = FileCamera;
  static const std::vector<ColmapModel> models{
      {"SIMPLE_PINHOLE", {&C::fx, &C::cx, &C::cy}, 0, true},
      {"PINHOLE", {&C::fx, &C::fy, &C::cx, &C::cy}},
      {"SIMPLE_RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1}, 0, true},
      {"RADIAL", {&C::fx, &C::cx, &C::cy, &C::k1, &C::k2}, 0, true},
      {"OPENCV", {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::p1, &C::p2}},
      {"FULL_OPENCV", {&C::fx, &C::fy, &C::cx, &C::cy, &C::k1, &C::k2, &C::p1, &C::p2, &C::k3}, 3}};
  return models;
}

int pixels_in(const ImageLines& lines, std::string_view word, std::string_view name) {
  const std::optional<int> found = pixel_count(static_cast<double>(lines.count_in(word, name)));
  if (!found) lines.fail(std::string(name) + " is not a number of pixels: " + std::string(word));
  return *found;
}

FileCamera colmap_camera(const ImageLines& lines, const std::vector<std::string_view>& words) {
  if (words.size() < 5) lines.fail("a camera has at least five fields: CAMERA_ID MODEL WIDTH HEIGHT PARAMS");
  FileCamera out;
  out.name = words[0];
  out.columns = pixels_in(lines, words[2], "WIDTH");
  out.rows = pixels_in(lines, words[3], "HEIGHT");
  for (const ColmapModel& m : colmap_models()) {
    if (words[1] != m.name) continue;
    if (words.size() != 4 + m.values.size() + m.zeros)
      lines.fail(std::string(m.name) + " has " + std::to_string(m.values.size() + m.zeros) + " parameters, here are " +
                 std::to_string(words.size() - 4));
    for (size_t k = 0; k < m.values.size(); ++k) out.*m.values[k] = lines.number_in(words[4 + k], "a parameter");
    if (m.one_focal) out.fy = out.fx;
    for (size_t k = 4 + m.values.size(); k < words.size(); ++k)
      if (lines.number_in(words[k], "a parameter") != 0.0)
        lines.fail("the camera's k4 to k6 are not 0: its distortion is not Brown's", "calibrate with the model OPENCV");
    return out;
  }
  lines.fail("the model of the camera is " + std::string(words[1]) + ", which is not Brown's",
             "known are SIMPLE_PINHOLE, PINHOLE, SIMPLE_RADIAL, RADIAL, OPENCV and FULL_OPENCV");
}

void read_colmap_marks(ImageLines& lines, std::string_view line, std::uint32_t image, NumberedNames& point_number, ImageData& out) {
  const auto words = blank_words(line);
  if (words.size() % 3 != 0) lines.fail("image points are not in threes: X Y POINT3D_ID");
  for (size_t k = 0; k < words.size(); k += 3)
    if (words[k + 2] != "-1")
      out.marks.push_back(
          {image, point_number(words[k + 2]), lines.number_in(words[k], "X"), lines.number_in(words[k + 1], "Y"), lines.number()});
}

void read_colmap_images(const std::filesystem::path& folder, const std::map<std::string, std::uint32_t, std::less<>>& camera_number,
                        ImageData& out) {
  ImageLines lines(folder / "images.txt");
  NumberedNames image_number(out.images), point_number(out.points);
  for (std::string_view line; lines.next_data(line);) {
    const auto words = blank_words(line);
    if (words.size() < 10) lines.fail("an image has ten fields: IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    std::array<double, 7> v{};
    for (size_t k = 0; k < v.size(); ++k) v[k] = lines.number_in(words[k + 1], "a pose");
    const auto camera = camera_number.find(words[8]);
    if (camera == camera_number.end()) lines.fail("camera " + std::string(words[8]) + " is not in cameras.txt");
    const size_t images = out.images.size();
    const std::string_view name = line.substr(static_cast<size_t>(words[9].data() - line.data()));  // may hold blanks
    const std::uint32_t image = image_number(name.substr(0, name.find_last_not_of(" \t") + 1));
    if (out.images.size() == images) lines.fail("image " + out.images[image] + " is there twice");
    out.camera_of.push_back(camera->second);
    const Eigen::Matrix3d R = Eigen::Quaterniond(v[0], v[1], v[2], v[3]).normalized().toRotationMatrix();
    const Eigen::Vector3d t(v[4], v[5], v[6]);
    out.poses.push_back({image, down_forward.asDiagonal() * R, -R.transpose() * t});
    if (!lines.next(line)) lines.fail("the line of the image's points is missing");
    read_colmap_marks(lines, line, image, point_number, out);
  }
}

std::string numbers(std::initializer_list<double> values) {
  std::string out;
  for (const double v : values) out += " " + core::format_number(v);
  return out;
}

void write_colmap_images(const std::filesystem::path& folder, const ImageData& data) {
  std::vector<std::string> marks(data.images.size());
  for (const ImageMark& m : data.marks)
    marks[m.image] +=
        (marks[m.image].empty() ? "" : " ") + core::format_number(m.x) + " " + core::format_number(m.y) + " " + std::to_string(m.point + 1);
  std::string text = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME, and a line of X Y POINT3D_ID\n";
  for (size_t i = 0; i < data.images.size(); ++i) {
    const Eigen::Matrix3d R = down_forward.asDiagonal() * data.poses[i].camera_R_frame;
    Eigen::Quaterniond q(R);
    if (q.w() < 0.0) q.coeffs() = -q.coeffs();
    const Eigen::Vector3d t = -R * data.poses[i].position;
    text += std::to_string(i + 1) + numbers({q.w(), q.x(), q.y(), q.z(), t.x(), t.y(), t.z()}) + " " +
            std::to_string(data.camera_of[i] + 1) + " " + data.images[i] + "\n" + marks[i] + "\n";
  }
  write_text_file(folder / "images.txt", text);
}

/// The place of a point in camera axes (x right, y down, z forward), pixels.
Eigen::Vector2d pixel_of(const FileCamera& c, const Eigen::Vector3d& d) {
  const double x = d.x() / d.z(), y = d.y() / d.z(), r2 = x * x + y * y, radial = 1.0 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  return {c.cx + c.fx * (x * radial + 2.0 * c.p1 * x * y + c.p2 * (r2 + 2.0 * x * x)),
          c.cy + c.fy * (y * radial + c.p1 * (r2 + 2.0 * y * y) + 2.0 * c.p2 * x * y)};
}

/// By point: mean distance of its marks from where the cameras see it, pixels.
std::vector<double> reprojection_errors(const ImageData& data, const std::vector<PlacedPoint>& points) {
  std::vector<double> sums(points.size(), 0.0);
  std::vector<int> marks(points.size(), 0);
  for (const ImageMark& m : data.marks) {
    const FilePose& pose = data.poses[m.image];
    const Eigen::Vector3d d = down_forward.asDiagonal() * (pose.camera_R_frame * (points[m.point].position - pose.position));
    sums[m.point] += (pixel_of(data.cameras[data.camera_of[m.image]], d) - Eigen::Vector2d(m.x, m.y)).norm();
    ++marks[m.point];
  }
  for (size_t p = 0; p < sums.size(); ++p) sums[p] /= std::max(1, marks[p]);
  return sums;
}

}  // namespace

ImageData read_colmap(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder / "images.txt") && std::filesystem::exists(folder / "images.bin"))
    throw core::Error("the COLMAP model is binary", folder.string(),
                      "convert it: colmap model_converter --input_path " + folder.string() + " --output_path TEXT --output_type TXT");
  ImageData out;
  out.file = folder;
  std::map<std::string, std::uint32_t, std::less<>> camera_number;
  ImageLines cameras(folder / "cameras.txt");
  for (std::string_view line; cameras.next_data(line);) {
    out.cameras.push_back(colmap_camera(cameras, blank_words(line)));
    if (!camera_number.try_emplace(out.cameras.back().name, static_cast<std::uint32_t>(out.cameras.size() - 1)).second)
      cameras.fail("camera " + out.cameras.back().name + " is there twice");
  }
  read_colmap_images(folder, camera_number, out);
  out.numbered.assign(out.points.size(), 1);
  return out;
}

void write_colmap(const std::filesystem::path& folder, const ImageData& data, const std::vector<PlacedPoint>& points) {
  std::filesystem::create_directories(folder);
  std::string text = "# CAMERA_ID MODEL WIDTH HEIGHT PARAMS\n";
  for (size_t c = 0; c < data.cameras.size(); ++c) {
    const FileCamera& k = data.cameras[c];
    text += std::to_string(c + 1) + " FULL_OPENCV " + std::to_string(k.columns) + " " + std::to_string(k.rows) +
            numbers({k.fx, k.fy, k.cx, k.cy, k.k1, k.k2, k.p1, k.p2, k.k3, 0.0, 0.0, 0.0}) + "\n";
  }
  write_text_file(folder / "cameras.txt", text);
  write_colmap_images(folder, data);
  std::vector<std::string> tracks(points.size());
  std::vector<size_t> on_image(data.images.size(), 0);
  for (const ImageMark& m : data.marks) tracks[m.point] += " " + std::to_string(m.image + 1) + " " + std::to_string(on_image[m.image]++);
  const std::vector<double> errors = reprojection_errors(data, points);
  text = "# POINT3D_ID X Y Z R G B ERROR TRACK[] as IMAGE_ID POINT2D_IDX\n";
  for (size_t p = 0; p < points.size(); ++p) {
    const Eigen::Vector3d& X = points[p].position;
    if (!tracks[p].empty())
      text += std::to_string(p + 1) + numbers({X.x(), X.y(), X.z()}) + " 128 128 128" + numbers({errors[p]}) + tracks[p] + "\n";
  }
  write_text_file(folder / "points3D.txt", text);
}

}  // namespace swath::io
