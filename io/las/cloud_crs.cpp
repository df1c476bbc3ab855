// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_crs.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <vector>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/las/las_crs.h"
#include "io/store/address.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Heights;

constexpr const char* hint = "name it as points.crs in the survey, for example crs = \"EPSG:25832+7837\" in [[points]]";
constexpr std::size_t longest_prj = 1 << 16;

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

/// The code of the CRS of that name whose coordinates are the same: WKT of ESRI has names alone. 0: none.
int code_by_name(const core::Crs& stated) {
  if (stated.epsg() != 0 || stated.has_vertical()) return stated.epsg();
  constexpr double same = 0.01;  // units of the CRS
  const core::Crs known(stated.name());
  double west = 0.0, south = 0.0, east = 0.0, north = 0.0;
  if (!known.area_of_use(west, south, east, north)) return 0;
  const Eigen::Vector3d at = core::Transform(core::wgs84_geodetic(), known)({0.5 * (west + east), 0.5 * (south + north), 0.0});
  const Eigen::Vector3d moved = core::Transform(known, stated)(at);
  return (moved - at).head<2>().norm() < same ? known.epsg() : 0;
}

core::Crs run_crs(const Survey& survey) { return survey.crs.empty() ? cloud_crs(survey, survey.points.front()) : core::Crs(survey.crs); }

}  // namespace

CrsBeside crs_beside(const fs::path& cloud) {
  for (const char* ending : {".prj", ".PRJ"}) {
    const fs::path file = fs::path(cloud).replace_extension(ending);
    if (is_address(file)) return {};  // the survey does not name it
    std::ifstream in(file, std::ios::binary);
    std::string text(longest_prj, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    if (text.empty()) continue;
    CrsBeside out;
    try {
      const core::Crs crs(text);
      out = {file.filename().string() + " beside it states " + crs.name() + ": ", "EPSG:CODE"};
      if (const int code = code_by_name(crs)) out.example = "EPSG:" + std::to_string(code);
      if (crs.epsg() && crs.vertical_epsg()) out.example += "+" + std::to_string(crs.vertical_epsg());
    } catch (const core::Error&) {  // what is not understood is not stated
    }
    return out;
  }
  return {};
}

std::string cloud_definition(const Survey& survey, const PointFile& f) {
  if (!f.crs.empty()) return f.crs;
  std::vector<std::string> ignored;
  const fs::path file = resolve(survey, f.file);
  const LasCrs stated = las_crs(read_las_header(file, ignored));
  if (stated.definition.empty()) {
    const CrsBeside beside = crs_beside(file);
    throw core::Error("states no CRS" + (stated.note.empty() ? std::string() : ": " + stated.note), file.string(),
                      beside.stated.empty()
                          ? std::string(hint)
                          : beside.stated + "name it as points.crs in the survey, crs = \"" + beside.example + "\" in [[points]]");
  }
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
