// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_crs.h"

#include <algorithm>
#include <map>
#include <vector>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/las/las_crs.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Heights;

constexpr const char* hint = "name it as points.crs in the survey, for example crs = \"EPSG:25832+7837\" in [[points]]";

std::string crs_example(const core::Crs& crs) { return crs.epsg() ? "EPSG:" + std::to_string(crs.epsg()) : std::string("EPSG:32632"); }

/// Both height systems stated, or neither.
void hold_heights(const core::Crs& cloud, const core::Crs& run, const std::string& file) {
  if (cloud.heights() == run.heights() || (cloud.heights() != Heights::unknown && run.heights() != Heights::unknown)) return;
  if (cloud.heights() == Heights::unknown) {
    const std::string plain = crs_example(cloud);
    const std::string level = run.vertical_epsg() ? plain + "+" + std::to_string(run.vertical_epsg()) : plain + "+5773";
    throw core::usage_error("the file's CRS, " + cloud.name() + ", does not state its height system, while the survey asks for " +
                                run.vertical_name() + ": no height is shifted on a guess",
                            file,
                            "state points.crs with its heights: \"" + level + "\", or \"" + plain +
                                "+ellipsoidal\" where they are ellipsoidal; or leave the vertical part out of the survey's crs");
  }
  if (cloud.heights() == Heights::vertical)
    throw core::usage_error(
        "its heights are " + cloud.vertical_name() + ", while the survey's crs, " + run.name() + ", does not state a height system", file,
        cloud.vertical_epsg() ? "state it in the survey: crs = \"" + crs_example(run) + "+" + std::to_string(cloud.vertical_epsg()) + "\""
                              : "state a vertical part in the survey's crs");
}

core::Crs run_crs(const Survey& survey) { return survey.crs.empty() ? cloud_crs(survey, survey.points.front()) : core::Crs(survey.crs); }

}  // namespace

std::string cloud_definition(const Survey& survey, const PointFile& f) {
  if (!f.crs.empty()) return f.crs;
  std::vector<std::string> ignored;
  const fs::path file = resolve(survey, f.file);
  const LasCrs stated = las_crs(read_las_header(file, ignored));
  if (stated.definition.empty())
    throw core::Error("states no CRS" + (stated.note.empty() ? std::string() : ": " + stated.note), file.string(), hint);
  return stated.definition;
}

core::Crs cloud_crs(const Survey& survey, const PointFile& f) {
  const std::string definition = cloud_definition(survey, f);
  const fs::path file = resolve(survey, f.file);
  try {
    return core::Crs(definition);
  } catch (const core::Error& e) {
    if (f.crs.empty()) throw core::Error(std::string("its CRS cannot be used: ") + e.what(), file.string(), hint);
    throw core::usage_error(e.what(), "points.crs of " + file.string(), e.hint());
  }
}

void check_clouds(const Survey& survey) {
  const core::Crs run = run_crs(survey);
  std::map<std::string, std::string> held;  // key of a CRS and the first file of it
  for (const PointFile& f : survey.points) {
    const core::Crs crs = cloud_crs(survey, f);
    const std::string file = resolve(survey, f.file).string();
    if (!held.emplace(crs.key(), file).second || core::is_same_crs(crs, run)) continue;
    hold_heights(crs, run, file);
    try {
      core::Transform(crs, run);
    } catch (const core::Error& e) {
      throw core::usage_error(e.what(), file, e.hint());
    }
  }
  if (run.heights() != Heights::unknown) return;
  std::vector<std::string> open, known;
  for (const PointFile& f : survey.points)
    (cloud_crs(survey, f).heights() == Heights::unknown ? open : known).push_back(resolve(survey, f.file).string());
  if (!open.empty() && !known.empty())
    throw core::usage_error("its CRS does not state its height system, while the heights of " + known.front() + " are ellipsoidal",
                            open.front(), "state points.crs of both with their heights, and the survey's crs too");
}

std::string heights_of_clouds(const Survey& survey) {
  const bool all = std::all_of(survey.points.begin(), survey.points.end(),
                               [&](const PointFile& f) { return cloud_crs(survey, f).heights() == Heights::ellipsoidal; });
  return std::string(all ? core::ellipsoidal_heights : core::unknown_heights);
}

double height_unit(const Survey& survey, const PointFile& file, const core::Crs& crs, double stated) {
  if (file.height_unit && crs.heights() != Heights::vertical) return file.height_unit->value;
  // Keys that give ellipsoidal heights a unit of their own.
  if (stated > 0.0 && file.crs.empty() && crs.heights() == Heights::ellipsoidal) return stated;
  if (crs.has_height_unit()) return crs.vertical_metres_per_unit();
  if (stated > 0.0) return stated;
  if (survey.height_unit) return survey.height_unit->value;
  return crs.is_geographic() ? 1.0 : crs.metres_per_unit();
}

}  // namespace swath::io
