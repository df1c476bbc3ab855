// SPDX-License-Identifier: GPL-3.0-or-later
// tracks.csv and reconstruction.json as read_opensfm() has them, cameras of the type brown.
#include <algorithm>

#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "io/images/image_file.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"

namespace swath::io {
namespace {

using core::Value;

Value list_of(const Eigen::Vector3d& v) {
  Value out = Value::array();
  for (int k = 0; k < 3; ++k) out.push(Value(v[k]));
  return out;
}

double larger_side(const FileCamera& c) { return std::max(c.columns, c.rows); }

Value camera_value(const FileCamera& c) {
  const double side = larger_side(c);
  return Value(Value::Object{{"projection_type", Value("brown")},
                             {"width", Value(c.columns)},
                             {"height", Value(c.rows)},
                             {"focal_x", Value(c.fx / side)},
                             {"focal_y", Value(c.fy / side)},
                             {"c_x", Value((c.cx - c.columns / 2.0) / side)},
                             {"c_y", Value((c.cy - c.rows / 2.0) / side)},
                             {"k1", Value(c.k1)},
                             {"k2", Value(c.k2)},
                             {"p1", Value(c.p1)},
                             {"p2", Value(c.p2)},
                             {"k3", Value(c.k3)}});
}

Value shot_value(const FilePose& pose, const std::string& camera) {
  const Eigen::Matrix3d R = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal() * pose.camera_R_frame;
  return Value(
      Value::Object{{"rotation", list_of(core::log_so3(R))}, {"translation", list_of(-R * pose.position)}, {"camera", Value(camera)}});
}

Value point_value(const PlacedPoint& p) {
  return Value(Value::Object{{"color", list_of(Eigen::Vector3d::Constant(128.0))}, {"coordinates", list_of(p.position)}});
}

std::string tracks_text(const ImageData& data) {
  std::string out = "OPENSFM_TRACKS_VERSION_v2\n";
  std::vector<size_t> features(data.images.size(), 0);
  for (const ImageMark& m : data.marks) {
    const FileCamera& c = data.cameras[data.camera_of[m.image]];
    const double side = larger_side(c);
    out += data.images[m.image] + "\t" + std::to_string(m.point + 1) + "\t" + std::to_string(features[m.image]++) + "\t" +
           core::format_number((m.x - c.columns / 2.0) / side) + "\t" + core::format_number((m.y - c.rows / 2.0) / side) +
           "\t0.001\t128\t128\t128\t-1\t-1\n";
  }
  return out;
}

}  // namespace

void write_opensfm(const std::filesystem::path& folder, const ImageData& data, const std::vector<PlacedPoint>& points) {
  for (const std::string& name : data.images)
    if (name.find_first_of("\t\n") != std::string::npos) throw core::Error("a name with a tab: " + name, folder.string());
  std::filesystem::create_directories(folder);
  Value::Object cameras, shots, places;
  for (const FileCamera& c : data.cameras) cameras.emplace_back(c.name, camera_value(c));
  for (const FilePose& p : data.poses) shots.emplace_back(data.images[p.image], shot_value(p, data.cameras[data.camera_of[p.image]].name));
  std::vector<char> marked(points.size(), 0);
  for (const ImageMark& m : data.marks) marked[m.point] = 1;
  for (size_t p = 0; p < points.size(); ++p) {
    if (!marked[p]) continue;
    places.emplace_back(std::to_string(p + 1), point_value(points[p]));
  }
  Value all = Value::array();
  all.push(Value(
      Value::Object{{"cameras", Value(std::move(cameras))}, {"shots", Value(std::move(shots))}, {"points", Value(std::move(places))}}));
  write_text_file(folder / "reconstruction.json", to_json(all));
  write_text_file(folder / "tracks.csv", tracks_text(data));
}

}  // namespace swath::io
