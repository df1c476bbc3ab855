// SPDX-License-Identifier: GPL-3.0-or-later
// The block of a run: cameras, image points and control of the survey, stations and attitudes by direct orientation.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "calib/block/block_files.h"
#include "calib/block/checks/checked_adjustment.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "io/vector/control.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

constexpr const char *block_folder = "block", *correlation_file = "orientation_correlation.csv";

struct BlockStageOptions : calib::BlockOptions {
  calib::DriftSets drift = calib::DriftSets::none;
  calib::Datum datum = calib::Datum::none;
  calib::ImageValues stations = calib::ImageValues::observed, attitudes = calib::ImageValues::observed;
};

template <class V>
void describe(BlockStageOptions& o, V& v) {
  v.option("drift", o.drift, "Unknown shift and drift of the stations beside the covariances: none, per block or per strip.",
           "Ackermann, eq 1");
  v.option("datum", o.datum, "Unknown datum of the trajectory against control: none, a shift, or with rotation and scale.");
  v.option("stations", o.stations, "observed: positions by the trajectory take part; start: values to start from.");
  v.option("attitudes", o.attitudes, "The same of its attitudes.");
  describe(static_cast<calib::BlockOptions&>(o), v);
  v.check(o.datum == calib::Datum::none || o.drift == calib::DriftSets::none,
          "datum and drift are both stated: the shift of a drift is that of the datum; state datum = \"none\"");
  v.check(o.stations == calib::ImageValues::observed || (o.drift == calib::DriftSets::none && o.datum == calib::Datum::none),
          "drift and datum have no effect: the stations are values to start from");
}

std::vector<std::string> block_stage_products(const BlockStageOptions&) { return {block_folder}; }

std::vector<fs::path> block_inputs(const io::Survey& survey) {
  std::vector<fs::path> out;
  for (io::ImageFile f : survey.image_points) {
    f.file = io::resolve(survey, f.file);
    for (fs::path& file : io::files_of(f)) out.push_back(std::move(file));
  }
  for (fs::path& file : files_in<&io::Survey::control>(survey)) out.push_back(std::move(file));
  return out;
}

void expect_image_points(const Context& context, const BlockStageOptions& o) {
  const io::Survey& s = context.survey;
  if (std::find(context.planned.begin(), context.planned.end(), correlation_file) == context.planned.end())
    throw core::usage_error("block.adjust: orientation.direct writes no covariances of stations and attitudes", s.name,
                            "state correlated_images = 1 or more for orientation.direct");
  if (s.cameras.empty()) throw core::usage_error("block.adjust: the survey has no [[camera]]", s.name, "describe it");
  if (s.image_points.empty())
    throw core::usage_error("block.adjust: the survey names no [[image_points]]", s.name, "name the file of points measured on its images");
  for (const io::SurveyCamera& c : s.cameras) {
    calib::camera_of(calib::config_of(c), s.name);
    if (c.sigma.boresight == "free" && o.attitudes != calib::ImageValues::observed)
      throw core::usage_error("block.adjust: the boresight of camera " + c.name + " is free, and attitudes are values to start from",
                              s.name, "state sigma.boresight = \"held\", or attitudes = \"observed\"");
    if (c.sigma.lever_arm == "free" && o.stations != calib::ImageValues::observed)
      throw core::usage_error("block.adjust: the lever arm of camera " + c.name + " is free, and stations are values to start from", s.name,
                              "state sigma.lever_arm = \"held\", or stations = \"observed\"");
  }
}

/// Where exposures are listed: the table of images, or the events of a camera.
fs::path exposures_file(const io::Survey& survey) {
  if (!survey.images.empty()) return survey.images.front().file;
  for (const auto& events : survey.events)
    for (const io::SurveyCamera& camera : survey.cameras)
      if (events.technique == camera.technique) return events.file;
  return survey.events.front().file;
}

calib::BlockConfig config_of_run(const Context& context, const BlockStageOptions& o) {
  const io::Survey& survey = context.survey;
  calib::BlockConfig out;
  out.crs = survey.crs, out.drift = o.drift, out.datum = o.datum;
  out.adjust = o;
  for (const io::SurveyCamera& c : survey.cameras) out.cameras.push_back(calib::config_of(c));
  for (io::ImageFile f : survey.image_points) {
    f.file = io::resolve(survey, f.file);
    out.image_points.push_back(std::move(f));
  }
  calib::ImagesConfig& i = out.images;
  i.file = context.made("images.csv"), i.correlation = context.made(correlation_file);
  i.angles = calib::ImageAngles::roll_pitch_heading, i.north = calib::ImageNorth::true_north;
  i.stations = o.stations, i.angle_use = o.attitudes;
  i.place = io::resolve(survey, exposures_file(survey)).string();
  i.angles_hint =
      "check axes and mounting of [[imu]], or angle_unit and signs of the columns of [[trajectory]], and boresight of [[camera]]";
  i.lacks = "is none of the images that have an orientation";
  i.lacks_hint =
      survey.images.empty()
          ? "its event is missing, is outside the trajectory, or has another id: list names and events in [[image]] where they differ"
          : "add it to [[image]]; its event may be missing or outside the trajectory";
  return out;
}

/// Single points: corners of targets are the laser's. One without a name has its place in the file: numbers would be those of tie points.
std::vector<calib::SurveyedPoint> surveyed_points(const Context& context, core::Tally& tally) {
  const core::Transform to_map(core::wgs84_ecef(), context.crs);
  std::vector<calib::SurveyedPoint> out;
  for (const io::ControlPoint& p : io::read_image_control(context.survey, tally))
    if (p.target.empty())
      out.push_back({p.is_named ? p.name : p.place, to_map(p.ecef), p.sigma_h, p.sigma_v, p.kind, p.use == io::ControlUse::check, p.place});
  return out;
}

/// Files none of whose points is on an image may be the laser's: one sentence for each takes the place of their names. Those of plan or
/// heights alone are of no use to it.
std::vector<std::string> files_without_image(const std::vector<calib::SurveyedPoint>& points, calib::ReadBlock& read) {
  const auto file_of = [](const std::string& place) { return place.substr(0, place.rfind(':')); };
  std::set<std::string> seen, others, names;
  for (const calib::StatedControl& c : read.control) seen.insert(file_of(c.place));
  for (const calib::SurveyedPoint& p : points) {
    const std::string file = file_of(p.place);
    if (seen.contains(file)) continue;
    if (p.kind != io::ControlKind::xyz)
      throw core::Error("no point of the file is on an image, and control of plan or heights alone serves images only", file,
                        "names of the file and of the image points may differ; or take its [[control]] out");
    others.insert(fs::path(file).filename().string());
    names.insert(p.name);
  }
  std::erase_if(read.control_without_image, [&](const std::string& name) { return names.contains(name); });
  std::vector<std::string> out;
  for (const std::string& file : others)
    out.push_back("no point of " + file + " is on an image: names differ, or it is the laser's control");
  return out;
}

/// Strips of images are those of a list, of the events or of flight lines. Images of none of them, as those taken in a turn, are not one
/// strip: a shift and a drift in common would bend those before the first line to those after the last, and one of its own takes two
/// stations.
void expect_strips(const calib::ReadBlock& read, const BlockStageOptions& o, const std::string& survey) {
  if (o.drift != calib::DriftSets::strip) return;
  constexpr size_t listed = 5;
  size_t without = 0;
  std::string names;
  for (const calib::BlockImage& i : read.block.images)
    if (i.strip == 0 && without++ < listed) names += (without > 1 ? ", " : "") + i.name;
  if (without == 0) return;
  if (without == read.block.images.size())
    throw core::usage_error("block.adjust: drift is per strip, and no image has the number of a strip", survey,
                            "name the column of strips in [[event]] or [[image]], or list the flight lines in [[line]]");
  if (without > listed) names += " and " + std::to_string(without - listed) + " more";
  throw core::Error(
      "block.adjust: drift is per strip, and " + core::counted(without, "image") + " of " + std::to_string(read.block.images.size()) +
          (without == 1 ? " has" : " have") + " no strip, or strip 0: " + names,
      survey, "list the images of strips in [[image]] and leave those of turns out; number strips from 1; or state drift = \"block\"");
}

calib::BlockFound adjust_images(const Context& context, const BlockStageOptions& o, const Output& to, core::Tally& tally) {
  const calib::BlockConfig config = config_of_run(context, o);
  const std::vector<calib::SurveyedPoint> control = surveyed_points(context, tally);
  context.progress(0.0, "reading image points");
  calib::ReadBlock read = calib::read_block(config, context.survey.name, control);
  expect_strips(read, o, context.survey.name);
  const std::vector<std::string> unseen = files_without_image(control, read);
  context.progress(0.2, "adjusting");
  auto [stated, solution, found] = calib::adjust_checked(read, config);
  context.progress(0.8, "writing");
  found.started_from = "direct orientation";
  found.direct = calib::compare_direct(stated, read, solution);
  found.findings.insert(found.findings.end(), unseen.begin(), unseen.end());
  calib::write_block(to.folder / block_folder, read, config, solution, found);
  return std::move(found);
}

}  // namespace

Entry block_adjust_stage() {
  return once<adjust_images>(
      "block.adjust",
      "Bundle adjustment of the flight's images with stations and attitudes by direct orientation: orientations, "
      "cameras, points with covariances.",
      {.check = expect_image_points, .inputs = block_inputs, .products = block_stage_products, .needs = {Product::orientations}});
}

}  // namespace swath::stages
