// SPDX-License-Identifier: GPL-3.0-or-later
// OpenSfM: tracks.csv (image, track, feature, x, y, scale, colour ..., tabs) and the first reconstruction of reconstruction.json. Its
// documentation ("Geometric Models"): normalised coordinates count from the middle of the image, y down, and the larger side is 1; rotation
// (a rotation vector) and translation take a point of the world (topocentric: east, north, up) to the camera (y down, z forward).
#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/geo/frames.h"
#include "io/images/image_file.h"
#include "io/images/image_lines.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

const Eigen::Vector3d opensfm_down_forward(1.0, -1.0, -1.0);

const core::Value& member(const core::Value& v, std::string_view key, const std::string& whose) {
  const core::Value* found = v.find(key);
  if (!found) throw core::Error(whose + " has no \"" + std::string(key) + "\"", v.where.text());
  return *found;
}

/// A member of the kind that `is` accepts.
const core::Value& member_of_kind(const core::Value& v, std::string_view key, const std::string& whose, bool (core::Value::*is)() const,
                                  const char* kind) {
  const core::Value& found = member(v, key, whose);
  if (!(found.*is)()) throw core::Error("\"" + std::string(key) + "\" of " + whose + " is not a " + kind, found.where.text());
  return found;
}
const std::string& text_in(const core::Value& v, std::string_view key, const std::string& whose) {
  return member_of_kind(v, key, whose, &core::Value::is_text, "text").as_text();
}
const core::Value::Object& table_in(const core::Value& v, std::string_view key, const std::string& whose) {
  return member_of_kind(v, key, whose, &core::Value::is_object, "table").members();
}
int pixels_in(const core::Value& v, std::string_view key, const std::string& whose) {
  const core::Value& found = member_of_kind(v, key, whose, &core::Value::is_number, "number");
  const std::optional<int> pixels = pixel_count(found.as_number());
  if (!pixels) throw core::Error("\"" + std::string(key) + "\" of " + whose + " is not a number of pixels", found.where.text());
  return *pixels;
}

double number_or(const core::Value& v, std::string_view key, double otherwise) {
  const core::Value* found = v.find(key);
  if (!found) return otherwise;
  if (!found->is_number()) throw core::Error(std::string(key) + " is not a number", found->where.text());
  return found->as_number();
}

Eigen::Vector3d vector_in(const core::Value& v, const std::string& what) {
  if (!v.is_array() || v.items().size() != 3) throw core::Error(what + " is not a list of three numbers", v.where.text());
  Eigen::Vector3d out;
  for (size_t k = 0; k < 3; ++k) {
    if (!v.items()[k].is_number()) throw core::Error(what + " is not a list of three numbers", v.where.text());
    out[static_cast<Eigen::Index>(k)] = v.items()[k].as_number();
  }
  return out;
}

FileCamera opensfm_camera(const std::string& name, const core::Value& v) {
  const std::string type = text_in(v, "projection_type", "camera " + name);
  if (type != "perspective" && type != "brown" && type != "radial" && type != "simple_radial")
    throw core::Error("camera " + name + " is of type " + type + ", which is not Brown's", v.where.text(),
                      "known are perspective, simple_radial, radial and brown");
  FileCamera out;
  out.name = name;
  out.columns = pixels_in(v, "width", "camera " + name);
  out.rows = pixels_in(v, "height", "camera " + name);
  const double side = std::max(out.columns, out.rows);
  const double f = number_or(v, "focal", 0.0);
  out.fx = side * number_or(v, "focal_x", f);
  out.fy = side * number_or(v, "focal_y", f);
  out.cx = out.columns / 2.0 + side * number_or(v, "c_x", 0.0);
  out.cy = out.rows / 2.0 + side * number_or(v, "c_y", 0.0);
  out.k1 = number_or(v, "k1", 0.0), out.k2 = number_or(v, "k2", 0.0), out.k3 = number_or(v, "k3", 0.0);
  out.p1 = number_or(v, "p1", 0.0), out.p2 = number_or(v, "p2", 0.0);
  return out;
}

/// Marks of images that the reconstruction has, in pixels.
void read_tracks(const std::filesystem::path& tracks, const std::map<std::string, std::uint32_t, std::less<>>& image_number,
                 ImageData& out) {
  ImageLines lines(tracks);
  NumberedNames point_number(out.points);
  for (std::string_view line; lines.next_data(line);) {
    if (line.starts_with("OPENSFM_TRACKS_VERSION")) continue;
    std::vector<std::string_view> words;
    for (size_t at = 0; at <= line.size();) {
      const size_t end = std::min(line.find('\t', at), line.size());
      words.push_back(line.substr(at, end - at));
      at = end + 1;
    }
    if (words.size() < 5) lines.fail("a line of tracks.csv has at least five fields between tabs: image track feature x y");
    const auto image = image_number.find(words[0]);
    if (image == image_number.end()) continue;  // matched, but not oriented
    const FileCamera& camera = out.cameras[out.camera_of[image->second]];
    const double side = std::max(camera.columns, camera.rows);
    out.marks.push_back({image->second, point_number(words[1]), camera.columns / 2.0 + side * lines.number_in(words[3], "x"),
                         camera.rows / 2.0 + side * lines.number_in(words[4], "y"), lines.number()});
  }
}

}  // namespace

ImageData read_opensfm(const std::filesystem::path& tracks) {
  ImageData out;
  out.file = tracks;
  const std::filesystem::path json = tracks.parent_path() / "reconstruction.json";
  const core::Value all = read_value_file(json);
  if (!all.is_array() || all.items().empty()) throw core::Error("no reconstruction in the file", json.string());
  const core::Value& first = all.items().front();
  std::map<std::string, std::uint32_t, std::less<>> camera_number;
  for (const auto& [name, camera] : table_in(first, "cameras", "the reconstruction")) {
    camera_number[name] = static_cast<std::uint32_t>(out.cameras.size());
    out.cameras.push_back(opensfm_camera(name, camera));
  }
  std::map<std::string, std::uint32_t, std::less<>> image_number;
  for (const auto& [name, shot] : table_in(first, "shots", "the reconstruction")) {
    const auto camera = camera_number.find(text_in(shot, "camera", "shot " + name));
    if (camera == camera_number.end()) throw core::Error("the camera of shot " + name + " is not listed", shot.where.text());
    const auto image = static_cast<std::uint32_t>(out.images.size());
    image_number[name] = image;
    out.images.push_back(name);
    out.camera_of.push_back(camera->second);
    const Eigen::Matrix3d R = core::exp_so3(vector_in(member(shot, "rotation", "shot " + name), "rotation"));
    const Eigen::Vector3d t = vector_in(member(shot, "translation", "shot " + name), "translation");
    out.poses.push_back({image, opensfm_down_forward.asDiagonal() * R, -R.transpose() * t});
  }
  read_tracks(tracks, image_number, out);
  out.numbered.assign(out.points.size(), 1);
  return out;
}

}  // namespace swath::io
