// SPDX-License-Identifier: GPL-3.0-or-later
// Orientation of images by the trajectory at their exposures.
#include "calib/block/direct_orientation.h"

#include <set>

#include "core/error.h"
#include "io/records/event_file.h"
#include "io/text/output_file.h"
#include "stages/adapters/adapters.h"
#include "stages/once.h"

namespace swath::stages {
namespace {

struct DirectStageOptions : calib::DirectOptions {};

template <class V>
void describe(DirectStageOptions& o, V& v) {
  describe(static_cast<calib::DirectOptions&>(o), v);
}

std::vector<std::string> direct_products(const DirectStageOptions& o) {
  std::vector<std::string> out{"orientation_direct.csv", "images.csv"};
  if (o.correlated_images > 0) out.emplace_back("orientation_correlation.csv");
  return out;
}

void expect_cameras(const Context& context, const DirectStageOptions&) {
  const io::Survey& s = context.survey;
  if (s.crs.empty())
    throw core::usage_error("orientation.direct: the survey states no CRS for the orientations", s.name,
                            "state it, for example crs = \"EPSG:32632\"");
  if (s.height_unit && s.height_unit->value != 1.0 && !core::Crs(s.crs).has_height_unit())
    throw core::usage_error(
        "orientation.direct: heights of orientations are in metres where the CRS has no vertical part, not in height_unit", s.name,
        "state crs with its vertical part, for example \"EPSG:2263+6360\", and leave height_unit out");
  if (s.events.empty()) throw core::usage_error("orientation.direct: the survey names no [[event]] file", s.name, "name the exposures");
  if (s.cameras.empty())
    throw core::usage_error("orientation.direct: the survey has no [[camera]]", s.name,
                            "describe it: mount, boresight and lever_arm, and the technique of its events");
  std::set<std::string> techniques;
  for (const io::EventFile& f : s.events) techniques.insert(io::technique_of(f));
  for (const io::SurveyCamera& c : s.cameras) {
    calib::expect_technique(c, techniques, s.name);
    calib::direct_camera(c, s.name);
  }
}

calib::Exposures exposures_in(const io::Survey& survey, const core::EventData& events) {
  std::vector<io::ListedImage> listed;
  for (const io::ImageListFile& f : survey.images)
    for (io::ListedImage& image : io::read_listed_images(io::resolve(survey, f.file), f)) listed.push_back(std::move(image));
  return calib::exposures_of(events, survey.cameras, listed, io::line_windows(survey), survey.name);
}

calib::DirectFound orient_images(const trajectory::Trajectory& trajectory, const core::EventData& events, const Context& context,
                                 const DirectStageOptions& o, const Output& to) {
  const io::Survey& survey = context.survey;
  calib::DirectFound found;
  std::vector<calib::DirectCamera> cameras;
  for (const io::SurveyCamera& c : survey.cameras) {
    cameras.push_back(calib::direct_camera(c, survey.name));
    if (c.sigma.boresight == "free") found.without.push_back("boresight of " + c.name);
    if (c.sigma.lever_arm == "free") found.without.push_back("lever arm of " + c.name);
  }
  const calib::Exposures exposures = exposures_in(survey, events);
  found.unnamed = exposures.events_left_out;
  const std::vector<calib::DirectImage> images = calib::direct_orientation(trajectory, exposures.images, cameras, context.crs, found);
  std::string table = calib::orientation_header(survey.crs);
  for (const calib::DirectImage& i : images) table += calib::orientation_line(i.name, cameras[i.camera].name, i.strip, i.orientation);
  io::write_text_file(to.folder / "orientation_direct.csv", table);
  io::write_text_file(to.folder / "images.csv", calib::direct_images_csv(images, cameras));
  if (o.correlated_images == 0) return found;
  calib::CorrelationFile file(to.folder / "orientation_correlation.csv", survey.crs);
  calib::direct_correlation(images, trajectory, o,
                            [&](const calib::CovariancePair& p) { file.add(images[p.image].name, images[p.other].name, p.value); });
  file.commit();
  return found;
}

}  // namespace

Entry direct_orientation_stage() {
  return once<orient_images>(
      "orientation.direct", "Orientation of images by trajectory, exposure times, lever arm and boresight, with covariances.",
      {.check = expect_cameras, .inputs = files_in<&io::Survey::images>, .products = direct_products, .gives = {Product::orientations}});
}

}  // namespace swath::stages
