// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/terrain/breaklines.h"

#include <algorithm>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/text/value_file.h"
#include "io/vector/breaklines.h"
#include "stages/adapters/adapters.h"
#include "stages/area.h"
#include "stages/waters.h"
#include "terrain/dtm.h"
#include "terrain/water/breakline_area.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

constexpr const char* settled_file = "breaklines.settled";
constexpr const char* options_file = "options.json";

/// The survey's features in metres of the run's Blocks.
std::vector<core::Breakline> features_of(const Context& context, core::Tally& tally) {
  std::vector<core::Breakline> out = io::read_breaklines(context.survey, context.product_crs, tally);
  for (core::Breakline& b : out)
    for (auto& part : b.parts)
      for (Eigen::Vector3d& v : part) {
        v = Eigen::Vector3d(v.x() * context.unit, v.y() * context.unit, v.z() * context.vertical_unit) - context.origin;
        if (!b.has_height) v.z() = 0.0;
      }
  Area area = context.area;  // lines reach beyond the points
  area.box = area.box.grown(around_clouds);
  area.box = {area.box.x0 - context.origin.x(), area.box.y0 - context.origin.y(), area.box.x1 - context.origin.x(),
              area.box.y1 - context.origin.y()};
  terrain::keep_in_area(out, area, context.origin, tally);
  return out;
}

struct SettleOptions : terrain::BreaklineOptions {
  std::vector<int> classes{core::point_class::ground};
};

template <class V>
void describe(SettleOptions& o, V& v) {
  describe(static_cast<terrain::BreaklineOptions&>(o), v);
  v.option("classes", o.classes, core::within(0, 255), "ASPRS classes of shore points.");
}

/// A lake or river as it was settled.
struct SettledWater {
  std::string place{}, kind{};
  std::optional<std::uint64_t> shore_points{};
  std::optional<double> lowest{}, highest{}, sigma{};
};
template <class V>
void describe(const SettledWater& r, V& v) {
  v.result("place", r.place, "File, layer and feature.");
  v.result("kind", r.kind, "lake or river.");
  v.result("shore_points", r.shore_points, "Points of the shore that its height comes from; absent where the feature states it.");
  v.result("lowest_m", r.lowest, core::metres(), "Lowest height.");
  v.result("highest_m", r.highest, core::metres(), "Highest height.");
  v.result("sigma_m", r.sigma, core::metres(), "Sigma of its heights.");
}

struct BreaklineCounts {
  std::uint64_t at_shores = 0;
};
template <class V>
void describe(const BreaklineCounts& r, V& v) {
  v.result("ground points at shores", r.at_shores, "Points near the shores of water without heights.");
}

struct BreaklineFindings {
  std::vector<SettledWater> waters{};
  std::uint64_t features = 0, edges = 0;
};
template <class V>
void describe(const BreaklineFindings& r, V& v) {
  v.tables("waters", r.waters, "Lakes and rivers.");
  v.result("features", r.features, core::plain().in_summary(), "Breaklines, boundaries and waters.");
  v.result("edges", r.edges, "Edges of the network that they make.");
}

SettledWater account(const Context& context, const core::Breakline& b, bool derived, size_t points) {
  SettledWater one{b.place.substr(b.place.rfind('/') + 1), b.kind == core::BreaklineKind::lake ? "lake" : "river"};
  if (derived) one.shore_points = points;
  if (!b.has_height) return one;
  const auto [low, high] = std::minmax_element(b.parts.front().begin(), b.parts.front().end(),
                                               [](const Eigen::Vector3d& p, const Eigen::Vector3d& q) { return p.z() < q.z(); });
  one.lowest = low->z() + context.origin.z();
  one.highest = high->z() + context.origin.z();
  one.sigma = b.sigma;
  return one;
}
fs::path shore_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "shores"); }

BreaklineCounts find_shores(const TileJob& job, const Context& context, const SettleOptions& o, RunCache& cache) {
  const std::vector<core::Breakline>& features = cache.get([&] {
    core::Tally unheard;  // the merge reads the same files and reports
    return features_of(context, unheard);
  });
  terrain::DtmOptions ground;
  ground.classes = o.classes;
  const auto shores = terrain::shore_points(job.block, terrain::terrain_rows(job.block, ground), job.own, features, o.water);
  write_rows(shore_file(job.folder, job.key), shores);
  return {shores.size()};
}
BreaklineFindings settle_features(const MergeJob& job, const Context& context, const SettleOptions& o, core::Tally& tally) {
  std::vector<core::Breakline> all = features_of(context, tally);
  std::vector<std::vector<terrain::ShorePoint>> shores(all.size());
  for (const TileKey key : job.tiles) {
    std::vector<terrain::ShorePoint> points;
    read_rows(shore_file(job.folder, key), points);
    for (const terrain::ShorePoint& p : points) {
      if (p.feature >= shores.size()) io::cut_short(shore_file(job.folder, key));
      shores[p.feature].push_back(p);
    }
  }
  std::vector<terrain::SettledLine> settled;
  BreaklineFindings found;
  for (size_t f = 0; f < all.size(); ++f) {
    const bool derived = all[f].is_water() && !all[f].has_height;
    const auto points = shores[f].size();
    if (all[f].is_water()) {
      all[f] = terrain::with_heights(all[f], std::move(shores[f]), o.water, tally);
      found.waters.push_back(account(context, all[f], derived, points));
    }
    settled.push_back({std::move(all[f]), derived});
  }
  const terrain::Breaklines ready(settled, o, context.origin);  // reports lines that meet at different heights
  found.features = settled.size();
  found.edges = ready.network().edges.size();
  io::write_text_file(job.folder / settled_file, terrain::pack(settled));
  terrain::BreaklineOptions mine = o;
  io::write_text_file(job.folder / options_file, io::to_json(core::effective_values(core::described(mine))));
  return found;
}

void expect_breaklines(const Context& context, const SettleOptions&) {
  if (context.survey.breaklines.empty())
    throw core::usage_error("terrain.breaklines: the survey names no [[breaklines]]", context.survey.name,
                            "name their files in survey.toml, or leave the stage out");
}

}  // namespace

const terrain::Breaklines* breaklines_of(const Context& context, RunCache& cache) {
  if (!context.grids || !context.grids->has(Product::breaklines)) return nullptr;
  const fs::path folder = context.grids->folder(Product::breaklines);
  return cache
      .get([&] {
        terrain::BreaklineOptions options;
        std::vector<core::Fault> faults;
        core::read_options(core::described(options), io::read_value_file(folder / options_file), "", faults);
        core::throw_if_any(faults);
        return std::make_unique<terrain::Breaklines>(
            terrain::unpack(io::read_text_file(folder / settled_file), (folder / settled_file).string()), options, context.origin);
      })
      .get();
}

std::vector<Box> waters_of(const Context& context) {
  std::vector<Box> out;
  if (!context.grids || !context.grids->has(Product::breaklines)) return out;
  const fs::path file = context.grids->folder(Product::breaklines) / settled_file;
  for (const terrain::SettledLine& line : terrain::unpack(io::read_text_file(file), file.string())) {
    const core::Breakline& b = line.line;
    if (!b.is_water() || !b.has_height) continue;
    Box box{1e300, 1e300, -1e300, -1e300};
    for (const auto& part : b.parts)
      for (const Eigen::Vector3d& v : part) {
        const double x = v.x() + context.origin.x(), y = v.y() + context.origin.y();
        box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x), std::max(box.y1, y)};
      }
    if (box.x0 <= box.x1) out.push_back(box);
  }
  return out;
}

Entry breaklines_stage() {
  return tile<find_shores, settle_features>(
      "terrain.breaklines", "Breaklines, boundaries and water of the survey made ready: lines noded, lakes flat, rivers falling.",
      {.columns = {.needs = {core::Column::classification, core::Column::flags}, .reads = {core::Column::sigma_v}},
       .gives = {Product::breaklines},
       .check = expect_breaklines,
       .inputs = files_in<&io::Survey::breaklines>});
}

}  // namespace swath::stages
