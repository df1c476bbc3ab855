// SPDX-License-Identifier: GPL-3.0-or-later
// Which files of an output folder a page shows: by the names that the stages give them.
#include <algorithm>

#include "core/error.h"
#include "core/printable.h"
#include "io/las/las_ending.h"
#include "tools/view/scene.h"

namespace swath::tools {
namespace {

namespace fs = std::filesystem;

constexpr int depth = 2;  // folders below the output folder that products lie in

std::string name_of(const fs::path& p) { return core::lower_case(p.filename().string()); }
bool is_copc(const fs::path& p) { return name_of(p).ends_with(".copc.laz"); }

/// Files below a folder, in the order of their names; what is hidden is not the user's.
std::vector<fs::path> files_below(const fs::path& folder, int levels = depth) {
  std::vector<fs::path> out, inner;
  for (const auto& e : fs::directory_iterator(folder)) {
    if (name_of(e.path()).starts_with(".")) continue;
    (e.is_directory() ? inner : out).push_back(e.path());
  }
  std::sort(out.begin(), out.end());
  std::sort(inner.begin(), inner.end());
  if (levels > 0)
    for (const fs::path& f : inner)
      for (fs::path& one : files_below(f, levels - 1)) out.push_back(std::move(one));
  return out;
}

std::vector<fs::path> clouds_of(const std::vector<fs::path>& files) {
  std::vector<fs::path> copc, points, all;
  for (const fs::path& f : files) {
    if (!io::has_las_ending(f)) continue;
    all.push_back(f);
    if (is_copc(f)) copc.push_back(f);
    if (name_of(f.parent_path()) == "points") points.push_back(f);
  }
  return !copc.empty() ? copc : !points.empty() ? points : all;
}

/// The first file with one of the endings, in the order of these.
fs::path first_of(const std::vector<fs::path>& files, const std::vector<std::string>& endings) {
  for (const std::string& ending : endings)
    for (const fs::path& f : files)
      if (name_of(f).ends_with(ending)) return f;
  return {};
}

}  // namespace

ProductFiles products_of(const std::vector<fs::path>& given) {
  ProductFiles out;
  for (const fs::path& p : given) {
    if (!fs::exists(p)) throw core::Error("there is no such file or folder", p.string());
    if (!fs::is_directory(p)) {
      if (!io::has_las_ending(p))
        throw core::usage_error("is neither a cloud nor a folder", p.string(),
                                "give the output folder of a run, or LAS, LAZ or COPC files");
      out.clouds.push_back(p);
      continue;
    }
    const std::vector<fs::path> files = files_below(p);
    for (const fs::path& cloud : clouds_of(files)) out.clouds.push_back(cloud);
    if (given.size() > 1) continue;
    out.folder = p;
    out.terrain = first_of(files, {"dtm.vrt", "dtm.tif"});
    out.contours = first_of(files, {"contours.gpkg"});
    out.trajectory = first_of(files, {".sbet"});
    out.report = first_of(files, {"report.json"});
  }
  if (out.clouds.empty() && out.terrain.empty())
    throw core::Error("holds neither points nor a terrain model", given.front().string(),
                      "give the output folder of a run (swath run ... --output OUT), or LAS, LAZ or COPC files");
  return out;
}

}  // namespace swath::tools
