// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/clouds.h"

#include <glob.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <memory>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/map_scale.h"
#include "core/geo/same_map.h"
#include "io/las/cloud_crs.h"
#include "io/las/las_crs.h"
#include "io/las/las_ending.h"
#include "io/las/las_reader.h"
#include "io/store/address.h"
#include "io/survey/read_survey.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_unreadable(const std::string& what, const fs::path& where, int code) {
  throw core::usage_error(what + ": " + std::generic_category().message(code), where.string(),
                          "name the files that you may read, or have the rights of the folder changed");
}

/// What to do about a folder without clouds of its own.
std::string hint_of_subfolders(const fs::path& folder) {
  std::size_t files = 0;
  std::error_code ec;
  for (fs::directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec)) {
    std::error_code inner;
    for (fs::directory_iterator in(at->path(), inner); !inner && in != end; in.increment(inner)) files += io::has_las_ending(in->path());
  }
  if (files == 0) return "name the files, or another folder";
  return "its subfolders hold " + std::to_string(files) + ": name '" + (folder / "*").string() + "/*.[lL][aA][sSzZ]'";
}

/// The LAS and LAZ files of a folder; of an Entwine Point Tile its index.
std::vector<fs::path> files_in_folder(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code ec;
  if (const fs::path index = folder / "ept.json"; fs::exists(index, ec)) return {index};
  for (fs::directory_iterator at(folder, ec), end; !ec && at != end; at.increment(ec))
    if (io::has_las_ending(at->path())) out.push_back(at->path());
  if (ec) refuse_unreadable("cannot read the folder", folder, ec.value());
  if (out.empty()) throw core::usage_error("the folder holds no LAS or LAZ file", folder.string(), hint_of_subfolders(folder));
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<fs::path> files_matching(const std::string& pattern) {
  glob_t found{};
  const std::unique_ptr<glob_t, void (*)(glob_t*)> owner(&found, globfree);
  errno = 0;
  const int code = ::glob(pattern.c_str(), GLOB_ERR, nullptr, &found);
  if (code == GLOB_NOMATCH) throw core::usage_error("no file matches the pattern", pattern, "quote it where the shell must not expand it");
  if (code != 0 && errno == ENOENT) throw core::usage_error("no such folder as the pattern names", pattern, "check its name");
  if (code != 0) refuse_unreadable("cannot read a folder of the pattern", pattern, errno ? errno : EIO);
  std::vector<fs::path> out;
  std::error_code ec;
  for (size_t k = 0; k < found.gl_pathc; ++k)
    if (const fs::path file = found.gl_pathv[k]; fs::is_directory(file, ec)) {
      const std::vector<fs::path> inside = files_in_folder(file);
      out.insert(out.end(), inside.begin(), inside.end());
    } else {
      out.push_back(file);
    }
  return out;
}

/// The CRS that a cloud states; nothing where it states none that is understood.
struct Stated {
  std::optional<core::Crs> crs;
  std::string why;                                   ///< there is none
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();  ///< of its bounds
  bool is_across = false;                            ///< in degrees: the antimeridian
};

Stated stated_crs(const fs::path& file) {
  std::vector<std::string> ignored;
  const io::LasHeader header = io::read_las_header(file, ignored);
  const io::LasCrs found = io::las_crs(header);
  Stated out;
  out.middle = 0.5 * (header.min + header.max).head<2>();
  // A cloud in degrees that is half a globe wide lies on both sides of the antimeridian.
  out.is_across = header.max.x() - header.min.x() > 180.0;
  if (found.definition.empty()) {
    out.why = "states no CRS" + (found.note.empty() ? std::string() : ": " + found.note);
    return out;
  }
  try {
    out.crs.emplace(found.definition);
  } catch (const core::Error& e) {
    out.why = std::string("states a CRS that cannot be used: ") + e.what();
  }
  return out;
}

std::string named(const core::Crs& crs) {
  const std::string heights = crs.has_height_unit() ? ", heights in " + crs.vertical_unit_name() : std::string();
  return crs.name() + " (" + crs.unit_name() + heights + ")";
}

/// What to do about a cloud that states no CRS.
std::string unstated_hint(const fs::path& file, CrsNamed by) {
  const io::CrsBeside beside = io::crs_beside(file);
  return beside.stated + (by == CrsNamed::in_pdal_pipeline ? "name its CRS: \"override_srs\": \"" + beside.example + "\" of its readers.las"
                                                           : "name its CRS: --crs " + beside.example);
}

void require_known(const std::string& crs, CrsNamed by) {
  try {
    core::Crs{crs};
  } catch (const core::Error& e) {
    throw core::usage_error(e.what(), (by == CrsNamed::in_pdal_pipeline ? "CRS of the pipeline: " : "--crs ") + crs, e.hint());
  }
}

/// One CRS for all, in units of length, or an error.
void require_one_crs(const core::Crs& first, const fs::path& first_file, const Stated& cloud, const fs::path& file, CrsNamed by) {
  if (first.is_geographic())
    throw core::usage_error("its coordinates are degrees (" + first.name() + "), and products need a map projection", first_file.string(),
                            std::string(by == CrsNamed::in_pdal_pipeline
                                            ? "name one with 'out_srs' of filters.reprojection right behind the readers, for example "
                                            : "name one with --crs, for example --crs ") +
                                core::utm_zone({cloud.is_across ? cloud.middle.x() + 180.0 : cloud.middle.x(), cloud.middle.y()}, first));
  if (core::is_same_crs(*cloud.crs, first)) return;
  const bool units = cloud.crs->unit_name() != first.unit_name() || (cloud.crs->has_height_unit() && first.has_height_unit() &&
                                                                     cloud.crs->vertical_unit_name() != first.vertical_unit_name());
  throw core::usage_error("the clouds are in different " + std::string(units ? "units and CRSs" : "CRSs") + ": this one in " +
                              named(*cloud.crs) + ", " + first_file.string() + " in " + named(first),
                          file.string(),
                          by == CrsNamed::in_pdal_pipeline
                              ? "filters.reprojection with 'out_srs' right behind the readers names that of the products"
                              : "name the CRS of the products with --crs, and clouds of others are transformed; or run each alone");
}

/// "EPSG:25832+7837", as far as its codes are known.
std::string code_with(const core::Crs& crs, int vertical) {
  return (crs.epsg() ? "EPSG:" + std::to_string(crs.epsg()) : "EPSG:CODE") + "+" + (vertical ? std::to_string(vertical) : "CODE");
}

/// Heights of the cloud and of `crs`, which is named for the products: both of a stated system, or neither.
void require_heights(const core::Crs& named_crs, const core::Crs& cloud, const fs::path& file, CrsNamed by) {
  using core::Heights;
  if (by == CrsNamed::in_pdal_pipeline || core::is_same_crs(cloud, named_crs)) return;
  const std::string given = "--crs " + named_crs.name();
  if (cloud.heights() == Heights::unknown && named_crs.heights() != Heights::unknown)
    throw core::usage_error(
        "its CRS, " + cloud.name() + ", does not state what its heights count from, while " + given + " asks for " +
            named_crs.vertical_name() + ": no height is shifted on a guess",
        file.string(),
        (named_crs.epsg() ? "name --crs EPSG:" + std::to_string(named_crs.epsg()) : "name --crs without its vertical part") +
            ", and the heights stay as they are; where they must change, state points.crs = \"" +
            code_with(cloud, named_crs.vertical_epsg()) + "\" with the cloud's own vertical code in a survey.toml, for `swath run`");
  if (cloud.heights() == Heights::vertical && named_crs.heights() == Heights::unknown)
    throw core::usage_error("its heights are " + cloud.vertical_name() + ", while " + given + " does not state what heights count from",
                            file.string(), "name the vertical part, too: --crs " + code_with(named_crs, cloud.vertical_epsg()));
}

}  // namespace

std::vector<fs::path> cloud_files(const std::vector<std::string>& names) {
  std::vector<fs::path> out;
  std::set<fs::path> known;
  for (const std::string& name : names) {
    std::error_code ec;
    std::vector<fs::path> found;
    if (io::is_address(name))
      found = {name};
    else if (fs::is_directory(name, ec))
      found = files_in_folder(name);
    else if (fs::exists(name, ec))
      found = {name};
    else if (name.find_first_of("*?[") != std::string::npos)
      found = files_matching(name);
    else
      throw core::usage_error("no such file or folder", name, "name LAS or LAZ files, folders of them, or patterns");
    for (fs::path& file : found)
      if (known.insert(io::is_address(file) ? file : fs::weakly_canonical(file, ec)).second) out.push_back(std::move(file));
  }
  return out;
}

core::Value cloud_survey(const std::vector<fs::path>& files, const std::string& crs, CrsNamed by) {
  if (!crs.empty()) require_known(crs, by);
  core::Value points = core::Value::array();
  std::optional<core::Crs> first;
  fs::path first_file;
  for (const fs::path& file : files) {
    core::Value& cloud = points.push(core::Value::object());
    cloud["file"] = io::full_name(file).string();
    if (!io::has_las_ending(file)) continue;  // their readers know them
    const Stated stated = stated_crs(file);
    if (!stated.crs && crs.empty()) throw core::usage_error(stated.why, file.string(), unstated_hint(file, by));
    if (!stated.crs) cloud["crs"] = crs;
    if (!crs.empty() && stated.crs) require_heights(core::Crs(crs), *stated.crs, file, by);
    if (!crs.empty()) continue;
    if (!first) first = stated.crs, first_file = file;
    require_one_crs(*first, first_file, stated, file, by);
  }
  core::Value survey = core::Value::object();
  survey["name"] = cloud_name(files);
  if (!crs.empty()) survey["crs"] = crs;
  survey["points"] = std::move(points);
  return survey;
}

bool has_class(const std::vector<fs::path>& files, int point_class) {
  constexpr size_t batch = 1 << 16;
  for (const fs::path& file : files) {
    if (!io::has_las_ending(file)) return true;
    io::LasReader reader(file);
    io::LasTime time;
    time.keep_unknown = true;
    core::Block block;
    while (reader.read(block, batch, time) > 0)
      if (std::find(block.classification.begin(), block.classification.end(), point_class) != block.classification.end()) return true;
  }
  return false;
}

std::string lack_of_crs(const fs::path& cloud) {
  core::Value tree = core::Value::object(), points = core::Value::array();
  points.push(core::Value::object())["file"] = io::full_name(cloud).string();
  tree["points"] = std::move(points);
  const io::Survey survey = io::read_survey(tree, fs::path());  // an index as its files
  for (const io::PointFile& f : survey.points) {
    if (!f.crs.empty()) continue;
    if (const Stated stated = stated_crs(io::resolve(survey, f.file)); !stated.crs) return stated.why;
  }
  return {};
}

std::string cloud_name(const std::vector<fs::path>& files) {
  const auto plain = [](fs::path file) {
    file = file.stem();
    return (file.extension() == ".copc" ? file.stem() : file).string();
  };
  if (files.size() == 1 && files.front().filename() != "ept.json") return plain(files.front());
  const fs::path folder = io::full_name(files.front()).parent_path();
  const bool together =
      std::all_of(files.begin(), files.end(), [&](const fs::path& file) { return io::full_name(file).parent_path() == folder; });
  return together && folder.has_filename() ? folder.filename().string() : "clouds";
}

fs::path proposed_output(const std::vector<fs::path>& files, const std::string& job) {
  const fs::path out = cloud_name(files) + "_" + job;
  std::error_code ec;
  if (!fs::exists(out, ec) || fs::exists(out / "report.json", ec) || fs::exists(out / ".swath", ec)) return out;
  if (fs::is_directory(out, ec) && fs::is_empty(out, ec)) return out;
  throw core::usage_error("is there already and holds no run of this program", out.string(),
                          "name the folder of the products with --output");
}

}  // namespace swath::pipeline
