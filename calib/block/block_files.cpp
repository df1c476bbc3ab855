// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "calib/block/block_page.h"
#include "calib/block/geolocation_files.h"
#include "calib/block/imagery/joint_covariance.h"
#include "calib/block/mark_plane.h"
#include "calib/block/orientation_table.h"
#include "calib/block/patb_files.h"
#include "core/config/result_visitors.h"
#include "core/config/units.h"
#include "core/geo/frames.h"
#include "io/las/las_writer.h"
#include "io/text/output_file.h"
#include "io/text/toml_text.h"
#include "io/text/value_file.h"
#include "io/vector/point_layer.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

std::vector<MatrixXd> image_covariances(const ReadBlock& read, const BlockSolution& s) {
  std::vector<MatrixXd> out(read.block.images.size());
  for (size_t n = 0; n < s.linear.nodes.size(); ++n)
    if (s.linear.nodes[n].kind == NodeKind::image) out[s.linear.nodes[n].index] = s.inference.nodes[n];
  return out;
}

ImageOrientation oriented(const ReadBlock& read, std::uint32_t image, const MatrixXd& covariance) {
  const BlockImage& i = read.block.images[image];
  const Matrix3d to_grid = read.frame.local_R_grid(i.position).transpose();
  ImageOrientation out;
  out.map = read.frame.map_of(i.position);
  out.grid_R_camera = to_grid * i.camera_R_local.transpose();
  Matrix3d ned_R_enu;
  ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  out.attitude = core::attitude_of(ned_R_enu * read.frame.local_R_true(i.position).transpose() * i.camera_R_local.transpose() *
                                   read.block.cameras[i.camera].body_R_camera.transpose());
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Identity();
  turn.topLeftCorner<3, 3>() = to_grid;
  out.covariance = turn * covariance * turn.transpose();
  return out;
}

std::vector<Geolocation> geolocations(const ReadBlock& read, const BlockSolution& s) {
  std::vector<Geolocation> out;
  const auto covariances = image_covariances(read, s);
  Matrix3d ned_R_enu;
  ned_R_enu << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  for (std::uint32_t i = 0; i < read.block.images.size(); ++i) {
    const BlockImage& image = read.block.images[i];
    const ImageOrientation o = oriented(read, i, covariances[i]);
    out.push_back({image.name, o.map,
                   upper_edge_attitude(ned_R_enu * read.frame.local_R_true(image.position).transpose() * image.camera_R_local.transpose()),
                   std::sqrt((o.covariance(0, 0) + o.covariance(1, 1)) / 2.0), std::sqrt(o.covariance(2, 2))});
  }
  return out;
}

/// Points that took no part are left out with their image points.
io::ImageData pixel_data(const ReadBlock& read, const BlockConfig& config, const BlockSolution& s, std::vector<io::PlacedPoint>& points) {
  io::ImageData out;
  const ImageBlock& b = read.block;
  std::vector<char> exact;
  for (size_t c = 0; c < b.cameras.size(); ++c) {
    auto camera = pixel_camera(b.cameras[c], config.cameras[c]);
    exact.push_back(camera.has_value());
    if (!camera) {
      BlockCamera plain = b.cameras[c];
      plain.value.tail<7>().setZero();
      camera = pixel_camera(plain, config.cameras[c]);
    }
    out.cameras.push_back(*camera);
  }
  for (std::uint32_t i = 0; i < b.images.size(); ++i) {
    out.images.push_back(b.images[i].name);
    out.camera_of.push_back(b.images[i].camera);
    out.poses.push_back({i, b.images[i].camera_R_local, b.images[i].position});
  }
  for (const BlockPoint& p : b.points) points.push_back({p.name, p.position});
  for (const ImageRay& r : b.rays) {
    if (s.linear.point_column[r.point] < 0) continue;
    const std::uint32_t camera = b.images[r.image].camera;
    Eigen::Vector2d p(r.x, r.y);
    if (!exact[camera]) {  // the distortion is taken off: the camera is without
      const auto d = direction_of(b.cameras[camera].value, b.cameras[camera].distortion, p);
      if (!d) continue;
      p = d->head<2>() + b.cameras[camera].value.segment<2>(1);
    }
    p = in_pixels(p, config.cameras[camera]);
    out.marks.push_back({r.image, r.point, p.x(), p.y(), 0});
  }
  return out;
}

/// Image points without distortion; those of points that took no part are left out.
void write_patb(const std::filesystem::path& folder, const ReadBlock& read, const BlockSolution& s) {
  const ImageBlock& b = read.block;
  std::vector<std::string> images, points;
  std::vector<PatbPhoto> photos;
  std::vector<PatbMark> marks;
  const MatrixXd none = MatrixXd::Zero(6, 6);
  for (std::uint32_t i = 0; i < b.images.size(); ++i) {
    const ImageOrientation o = oriented(read, i, none);
    images.push_back(b.images[i].name);
    photos.push_back({images.back(), b.cameras[b.images[i].camera].value[0], o.map, o.grid_R_camera});
  }
  for (const BlockPoint& p : b.points) points.push_back(p.name);
  for (const ImageRay& r : b.rays) {
    if (s.linear.point_column[r.point] < 0) continue;
    const BlockCamera& camera = b.cameras[b.images[r.image].camera];
    if (const auto d = direction_of(camera.value, camera.distortion, {r.x, r.y})) marks.push_back({r.image, r.point, d->x(), d->y()});
  }
  const std::vector<std::string> patb_images = patb_names(images), patb_points = patb_names(points);
  std::filesystem::create_directories(folder);
  io::write_text_file(folder / "block.im", patb_image_coordinates(photos, patb_images, patb_points, marks));
  io::write_text_file(folder / "block.ori", patb_orientations(photos, patb_images));
  const std::string table = patb_name_table(images, patb_images, points, patb_points);
  table.empty() ? static_cast<void>(std::filesystem::remove(folder / "names.csv")) : io::write_text_file(folder / "names.csv", table);
}

std::vector<io::NamedPoint> points_of(const ReadBlock& read, const BlockSolution& s) {
  const ImageBlock& b = read.block;
  std::vector<const char*> kind(b.points.size(), "tie");
  for (const BlockControl& c : b.control) kind[c.point] = c.check ? "check" : "control";
  std::vector<int> rays(b.points.size(), 0);
  for (const ImageRay& r : b.rays) ++rays[r.point];
  std::vector<io::NamedPoint> out;
  for (size_t p = 0; p < b.points.size(); ++p) {
    if (s.linear.point_column[p] < 0) continue;
    const Matrix3d R = read.frame.local_R_grid(b.points[p].position).transpose();
    const Vector3d sigma = (R * s.inference.points[p] * R.transpose()).diagonal().cwiseSqrt();
    out.push_back({b.points[p].name,
                   kind[p],
                   read.frame.map_of(b.points[p].position),
                   {static_cast<double>(rays[p]), sigma.x(), sigma.y(), sigma.z()}});
  }
  return out;
}

/// Points of points_of() as a cloud: user data the number of image points, class 1 (tie) or 8 (surveyed), withheld where they do not fit.
void write_points_laz(const std::filesystem::path& file, const std::string& crs, const std::vector<io::NamedPoint>& points,
                      const UnfitPoints& unfit) {
  const std::set<std::string_view> wrong(unfit.others.begin(), unfit.others.end());
  constexpr double most_rays = 255.0;
  constexpr std::uint8_t key_point = 8;
  core::Block cloud;
  if (!points.empty()) cloud.origin = points.front().position;
  for (const io::NamedPoint& p : points) {
    const Vector3d at = p.position - cloud.origin;
    cloud.x.push_back(at.x()), cloud.y.push_back(at.y()), cloud.z.push_back(at.z());
    cloud.classification.push_back(p.kind == "tie" ? 1 : key_point);
    cloud.user_data.push_back(static_cast<std::uint8_t>(std::min(most_rays, p.values[0])));
    cloud.sigma_h.push_back(static_cast<float>(std::hypot(p.values[1], p.values[2])));
    cloud.sigma_v.push_back(static_cast<float>(p.values[3]));
    cloud.flags.push_back(wrong.contains(p.name) ? core::flag::withheld : std::uint16_t{0});
  }
  io::LasWriteOptions o;
  if (!crs.empty()) o.crs_wkt = core::Crs(crs).wkt1();
  o.threads = 1;
  io::LasWriter writer(file, o);
  if (cloud.size() > 0) writer.write(cloud);
  writer.finish();
}

std::string lengths(const Vector3d& v) {
  return "[\"" + core::format_number(v.x()) + " m\", \"" + core::format_number(v.y()) + " m\", \"" + core::format_number(v.z()) + " m\"]";
}

}  // namespace

std::string orientation_csv(const ReadBlock& read, const BlockConfig& config, const BlockSolution& s) {
  std::string out = orientation_header(config.crs);
  const auto covariances = image_covariances(read, s);
  for (std::uint32_t i = 0; i < read.block.images.size(); ++i) {
    const BlockImage& image = read.block.images[i];
    out += orientation_line(image.name, read.block.cameras[image.camera].name, image.strip, oriented(read, i, covariances[i]));
  }
  return out;
}

JointCovariance joint_covariance(const ReadBlock& read, const BlockSolution& s) {
  JointCovariance out;
  const auto spread = [&](size_t camera, const auto& from, auto to) {  // free values among all
    const std::vector<int>& free = s.linear.nodes[camera].components;
    for (size_t k = 0; k < free.size(); ++k) to.col(free[k]) = from.col(static_cast<Eigen::Index>(k));
  };
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    const UnknownNode& node = s.linear.nodes[n];
    if (node.kind == NodeKind::camera) {
      Eigen::Matrix<double, Eigen::Dynamic, camera_values> columns =
          Eigen::Matrix<double, Eigen::Dynamic, camera_values>::Zero(s.inference.nodes[n].rows(), camera_values);
      spread(n, s.inference.nodes[n], columns.leftCols(camera_values));
      CameraCovariance all = CameraCovariance::Zero();
      spread(n, columns.transpose(), all.leftCols<camera_values>());
      out.cameras[read.block.cameras[node.index].name] = all;
    }
    if (node.kind != NodeKind::image || s.inference.camera_of[n] < 0) continue;
    const BlockImage& image = read.block.images[node.index];
    MatrixXd by_camera = s.inference.with_camera[n];
    by_camera.topRows<3>() = read.frame.local_R_grid(image.position).transpose() * by_camera.topRows<3>();
    PoseByCamera all = PoseByCamera::Zero();
    spread(static_cast<size_t>(s.inference.camera_of[n]), by_camera, all.leftCols<camera_values>());
    out.images[image.name] = all;
  }
  return out;
}

std::string camera_toml(const ReadBlock& read, const BlockConfig& config, const BlockFound& found) {
  const bool of_survey = std::any_of(config.cameras.begin(), config.cameras.end(), [](const CameraConfig& c) { return c.of_survey; });
  std::string out = "# Cameras after the adjustment: tables that " + std::string(of_survey ? "survey.toml" : "`swath block`") +
                    " takes. Values in brackets are standard deviations.\n";
  for (size_t c = 0; c < read.block.cameras.size(); ++c) {
    const BlockCamera& camera = read.block.cameras[c];
    const CameraConfig& k = config.cameras[c];
    out += "\n[[camera]]\nname = " + io::toml_scalar(camera.name) + "\n";
    for (int i = 0; i < camera_values; ++i) {
      const CameraValueFound& v = found.cameras[c].values[static_cast<size_t>(i)];
      const std::string number = core::format_number(v.value);
      out += v.name + " = " + (i < 3 ? "\"" + number + " mm\"" : number) +
             (v.held ? "" : "  # (" + core::format_number(v.sigma) + (v.unit.empty() ? "" : " " + v.unit) + ")") + "\n";
    }
    out += std::string("distortion = \"") + (camera.distortion == DistortionAt::ideal ? "ideal" : "measured") + "\"\n";
    if (k.pixel)
      out += "columns = " + std::to_string(k.columns) + "\nrows = " + std::to_string(k.rows) + "\npixel = \"" +
             core::format_number(std::round(1e12 * k.pixel->value) / 1e6) + " um\"\n";
    // The mount stays; what is left of the rotation is the boresight.
    const Matrix3d mount = camera_mounting(k.mount, {});
    const core::Attitude b = core::attitude_of(camera.body_R_camera * mount.transpose());
    out += "mount = \"" + core::format_number(k.mount.value / core::degree) + " deg\"\nboresight = [\"" +
           core::format_number(b.roll / core::degree) + " deg\", \"" + core::format_number(b.pitch / core::degree) + " deg\", \"" +
           core::format_number(core::wrap_pi(b.heading) / core::degree) + " deg\"]\n";
    const Vector3d arm = camera.body_R_camera * camera.antenna;
    if (!k.of_survey) {
      out += "antenna = " + lengths(arm) + "\n";
      continue;
    }
    const auto& stated = k.of_survey->lever_arm;
    out += "lever_arm = " + lengths(Vector3d(stated[0].value, stated[1].value, stated[2].value) - arm) + "\n";
    if (!k.of_survey->technique.empty()) out += "technique = " + io::toml_scalar(k.of_survey->technique) + "\n";
  }
  return out;
}

std::vector<std::string> block_products() {
  return {"orientation.csv", joint_covariance_file, "geo.txt", "geolocation.csv", "camera.toml",
          "points.gpkg",     "points.laz",          "colmap",  "opensfm",         "patb",
          "block.json",      "report.html"};
}

std::vector<std::string> write_block(const std::filesystem::path& folder, const ReadBlock& read, const BlockConfig& config,
                                     const BlockSolution& s, const BlockFound& found) {
  std::filesystem::create_directories(folder);
  std::vector<std::string> out;
  const auto text = [&](const char* name, const std::string& what) {
    io::write_text_file(folder / name, what);
    out.emplace_back(name);
  };
  text("orientation.csv", orientation_csv(read, config, s));
  if (const JointCovariance joint = joint_covariance(read, s); !joint.images.empty())
    text(joint_covariance_file, joint_covariance_csv(config.crs, joint));
  else
    std::filesystem::remove(folder / joint_covariance_file);  // that of an earlier block would be read with these orientations
  if (!read.frame.is_local()) {
    const std::vector<Geolocation> images = geolocations(read, s);
    text("geo.txt", geo_text(config.crs, images));
    text("geolocation.csv", geolocation_csv(config.crs, images, core::Crs(config.crs).is_geographic()));
  }
  text("camera.toml", camera_toml(read, config, found));
  const std::string crs = read.frame.is_local() ? "" : config.crs;
  const std::vector<io::NamedPoint> points = points_of(read, s);
  io::write_point_layer(folder / "points.gpkg", "points", crs, {"image_points", "sigma_east", "sigma_north", "sigma_up"}, points);
  out.emplace_back("points.gpkg");
  if (crs.empty() || !core::Crs(crs).is_geographic()) {
    write_points_laz(folder / "points.laz", crs, points, found.unfit);
    out.emplace_back("points.laz");
    write_patb(folder / "patb", read, s);
    out.emplace_back("patb");
  }
  if (std::all_of(config.cameras.begin(), config.cameras.end(),
                  [](const CameraConfig& c) { return c.pixel && c.columns > 0 && c.rows > 0; })) {
    std::vector<io::PlacedPoint> places;
    const io::ImageData data = pixel_data(read, config, s, places);
    io::write_colmap(folder / "colmap", data, places);
    out.emplace_back("colmap");
    io::write_opensfm(folder / "opensfm", data, places);
    out.emplace_back("opensfm");
  }
  text("block.json", io::to_json(core::reported(found)));
  text("report.html", block_page(read, config, s, found));
  return out;
}

}  // namespace swath::calib
