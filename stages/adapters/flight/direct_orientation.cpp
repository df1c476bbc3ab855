// SPDX-License-Identifier: GPL-3.0-or-later
// Orientation of images by the trajectory at their exposures.
#include "calib/block/direct_orientation.h"

#include "core/error.h"
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

void expect_map(const Context& context, const DirectStageOptions&) {
  if (context.survey.crs.empty())
    throw core::usage_error("orientation.direct: the survey states no CRS for the orientations", context.survey.name,
                            "state it, for example crs = \"EPSG:32632\"");
  if (context.survey.events.empty())
    throw core::usage_error("orientation.direct: the survey names no [[event]] file", context.survey.name, "name the exposures");
}

calib::DirectFound orient_images(const trajectory::Trajectory& trajectory, const core::EventData& events, const Context& context,
                                 const DirectStageOptions& o, const Output& to) {
  calib::DirectFound found;
  const std::vector<calib::DirectImage> images = calib::direct_orientation(trajectory, events, context.crs, o, found);
  std::string table = calib::orientation_header(context.survey.crs);
  for (const calib::DirectImage& i : images) table += calib::orientation_line(i.name, o.camera, i.strip, i.orientation);
  io::write_text_file(to.folder / "orientation_direct.csv", table);
  io::write_text_file(to.folder / "images.csv", calib::direct_images_csv(images, o.camera));
  if (o.correlated_images == 0) return found;
  calib::CorrelationFile file(to.folder / "orientation_correlation.csv", context.survey.crs);
  calib::direct_correlation(images, trajectory, o,
                            [&](const calib::CovariancePair& p) { file.add(images[p.image].name, images[p.other].name, p.value); });
  file.commit();
  return found;
}

}  // namespace

Entry direct_orientation_stage() {
  return once<orient_images>("orientation.direct",
                             "Orientation of images by trajectory, exposure times, lever arm and boresight, with covariances.",
                             {.check = expect_map, .products = direct_products});
}

}  // namespace swath::stages
