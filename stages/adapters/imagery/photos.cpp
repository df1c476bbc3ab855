// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/imagery/photos.h"

#include <algorithm>
#include <cmath>

#include "calib/block/imagery/undistort.h"
#include "core/config/units.h"
#include "core/error.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

constexpr const char *of_block = "block/orientation.csv", *camera_of_block = "block/camera.toml", *of_trajectory = "orientation_direct.csv";

bool is_planned(const Context& context, std::string_view product) { return std::ranges::count(context.planned, product) > 0; }

calib::PhotoSource source_of(const Context& context, const io::PhotoFiles& f) {
  const io::Survey& survey = context.survey;
  calib::PhotoSource out{io::resolve(survey, f.folder), {}, f.crs, {}, survey.name};
  const bool by_run = f.orientation.empty();
  const fs::path by_block = context.made(of_block);
  if (!by_run)
    out.orientation = io::resolve(survey, f.orientation);
  else
    out.orientation = by_block.empty() ? context.made(of_trajectory) : by_block;
  if (!f.camera.empty() || !by_block.empty()) {
    const fs::path file = f.camera.empty() ? context.made(camera_of_block) : io::resolve(survey, f.camera);
    out.cameras = calib::read_cameras(file);
    out.camera_place = file.string();
  } else {
    for (const io::SurveyCamera& c : survey.cameras) out.cameras.push_back(calib::config_of(c));
  }
  return out;
}

}  // namespace

void expect_photos(const Context& context, std::string_view stage) {
  const io::Survey& s = context.survey;
  const std::string name(stage);
  if (s.photos.empty())
    throw core::usage_error(name + ": the survey names no [[photos]]", s.name, "name their folder, and orientation and camera");
  for (const io::PhotoFiles& f : s.photos) {
    if (f.orientation.empty() && !is_planned(context, "block") && !is_planned(context, of_trajectory))
      throw core::usage_error(name + ": nothing orients the photographs of " + f.folder.string(), s.name,
                              "state orientation of [[photos]], or put orientation.direct or block.adjust before this stage");
    if (f.camera.empty() && s.cameras.empty())
      throw core::usage_error(name + ": no camera is described for the photographs of " + f.folder.string(), s.name,
                              "state camera of [[photos]], as camera.toml of `swath block`");
  }
}

std::vector<fs::path> photo_inputs(const io::Survey& survey) {
  std::vector<fs::path> out;
  for (const io::PhotoFiles& f : survey.photos) {
    for (const fs::path& table : {f.orientation, f.camera})
      if (!table.empty()) out.push_back(io::resolve(survey, table));
    std::error_code ec;
    if (!f.orientation.empty())
      if (const fs::path beside = io::resolve(survey, f.orientation).parent_path() / calib::joint_covariance_file; fs::exists(beside, ec))
        out.push_back(beside);
    const std::vector<fs::path> photos = calib::photographs_in(io::resolve(survey, f.folder));
    out.insert(out.end(), photos.begin(), photos.end());
  }
  return out;
}

calib::OrientedImages photos_of(const Context& context) {
  std::vector<calib::PhotoSource> sources;
  for (const io::PhotoFiles& f : context.survey.photos) sources.push_back(source_of(context, f));
  calib::MetreMap map;
  if (!context.crs.empty()) {
    map.crs = context.crs.wkt(), map.unit = context.unit;
    map.vertical_unit = context.crs.has_height_unit() ? context.vertical_unit : 1.0;
  }
  return calib::read_oriented_images(sources, map);
}

PhotoFindings findings_of(const calib::OrientedImages& images) {
  const auto rims = std::ranges::count_if(images.rims, [](const calib::BlackRim& rim) { return rim.any(); });
  return {images.images.size(), static_cast<std::uint64_t>(rims), images.without_file.size(), images.without_file};
}

void expect_seen(const calib::OrientedImages& images, const Context& context, const std::vector<TileKey>& tiles, std::uint64_t seen,
                 std::string_view stage) {
  if (seen > 0 || tiles.empty()) return;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const TileKey key : tiles) {
    const Box box = context.box_of(key);
    middle += Eigen::Vector2d(box.x0 + box.x1, box.y0 + box.y1) / (2.0 * static_cast<double>(tiles.size()));
  }
  const auto distance = [&](const calib::OrientedImage& i) { return (i.map.head<2>() - middle).norm(); };
  const auto nearest =
      std::min_element(images.images.begin(), images.images.end(),
                       [&](const calib::OrientedImage& a, const calib::OrientedImage& b) { return distance(a) < distance(b); });
  throw core::Error(std::string(stage) + ": no photograph sees the survey; the nearest, " + nearest->name + ", was taken " +
                        core::format_quantity(core::Dimension::length, std::round(distance(*nearest))) +
                        " from its middle, at a height of " + core::format_quantity(core::Dimension::length, std::round(nearest->map.z())),
                    context.survey.name, "check the CRS of the orientations, their heights, and omega, phi, kappa");
}

double photo_memory(const Context& context) {
  constexpr double bands = 4.0;
  double pixels = 0.0;
  const auto add = [&](int columns, int rows) { pixels = std::max(pixels, static_cast<double>(columns) * rows); };
  for (const io::SurveyCamera& c : context.survey.cameras) add(c.columns, c.rows);
  for (const io::PhotoFiles& f : context.survey.photos)
    if (!f.camera.empty())
      for (const calib::CameraConfig& c : calib::read_cameras(io::resolve(context.survey, f.camera))) add(c.columns, c.rows);
  return bands * sizeof(std::uint16_t) * pixels;
}

}  // namespace swath::stages
