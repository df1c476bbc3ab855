// SPDX-License-Identifier: GPL-3.0-or-later
// Check points against the ground points and the terrain model: accuracy by cover, class of the map, and whose fault a difference is.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <tuple>

#include "core/config/units.h"
#include "core/geo/undulation.h"
#include "core/statistics.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "io/vector/control.h"
#include "quality/cover_words.h"
#include "quality/mark_faults.h"
#include "quality/roof_planimetry.h"
#include "report/volumes.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/scanner.h"
#include "stages/adapters/quality/mark_files.h"
#include "stages/adapters/quality/seen_cells.h"
#include "stages/adapters/units.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

constexpr size_t names_shown = 6;
constexpr double outside_from = 100.0;                    // m: a check point farther from all of these cells lies outside
constexpr const char* points_file = "check_points.json";  // for report.quality

struct CheckPointOptions {
  std::string name = "check_points";
  core::Metres radius{1.0};
  quality::MarkSurface surface = quality::MarkSurface::plane;
  std::vector<std::string> open{"", "open", "bare", "urban", "NVA"};
  MapOptions map{};
};

template <class V>
void describe(CheckPointOptions& o, V& v) {
  v.option("name", o.name, "Name of the table and the layer of all check points: NAME.csv, NAME.gpkg.");
  v.option("radius", o.radius, core::above_to(0.0, 20.0), "Ground points within this distance of a check point are compared with it.");
  v.option("surface", o.surface, "plane: through the ground points, at the check point; mean: of their heights.");
  v.option("open", o.open, "Covers, also by their words in other languages, that count as not vegetated; \"\": none stated.");
  v.table("map", o.map, "Class of a map made from the survey.");
}

double halo(const CheckPointOptions& o) { return o.radius.value; }

struct CheckPointFindings {
  std::optional<std::string> none{};
  std::vector<CheckFileRead> files{};
  std::uint64_t marks = 0, corners = 0;
  std::vector<std::string> outside{}, unread{};
  std::optional<double> nva{}, vva{}, vva_95{};
  std::vector<CoverAccuracy> accuracy{};
  std::optional<MapClassFound> map{};
  std::vector<quality::LineAtMarks> lines{};
  std::optional<std::string> no_planimetry{}, beams{};
  std::optional<quality::RoofPlanimetry> planimetry{};
  std::vector<quality::RoofShift> roofs{};
  std::vector<quality::NamedFault> named{};
};

template <class V>
void describe(const CheckPointFindings& r, V& v) {
  using core::metres;
  v.result("check_points", r.none, core::plain().in_summary(), "Why nothing was compared.");
  v.tables("files", r.files, "Tables of check points with the columns that were taken; numbers count from 1.");
  v.result("marks", r.marks, core::plain().only_if(!r.none), "Check points of the survey.");
  v.result("corners", r.corners, core::if_any(), "Corners of targets, whose edges are compared.");
  v.result("outside", r.outside, core::plain().only_if(!r.outside.empty()),
           "Check points farther than 100 m from all points of the survey.");
  v.result("unread", r.unread, core::plain().only_if(!r.unread.empty()), "Check points without ground points around them.");
  v.result("nva_m", r.nva, metres().in_summary().limited_by("nva"),
           "RMSE of the ground points at three or more open check points, their error added.");
  v.result("vva_m", r.vva, metres().in_summary().limited_by("vva"), "RMSE of the ground points under vegetation, the same way.");
  v.result("vva_95_m", r.vva_95, metres(), "95 % of the ground points' absolute errors under vegetation are smaller.");
  v.tables("accuracy", r.accuracy, "Errors by product and cover.");
  v.table("map", r.map, "Class of a map made from the survey.");
  v.tables("lines", r.lines, "Flight lines against the check points that they show.");
  v.result("no_planimetry", r.no_planimetry, "Why no roof is compared, where there are check targets.");
  v.result("beams", r.beams, "What shows where the beams pass the roofs.");
  v.table("planimetry", r.planimetry, "Horizontal accuracy by the edges of roofs that are check targets.");
  v.tables("roofs", r.roofs, "Each of these roofs: cloud less target.");
  v.tables("named", r.named, "Whose fault the largest differences are.");
}

struct Marks {
  std::vector<quality::CheckMark> list;
  std::vector<quality::RoofTarget> targets{};
  std::uint64_t corners = 0;  ///< of targets
};

Marks marks_of(const Context& context) {
  Marks out;
  core::Tally of_others;
  const core::Transform to_map(core::wgs84_ecef(), context.crs);
  for (const io::ControlPoint& p : io::read_control(context.survey, of_others)) {
    if (p.use != io::ControlUse::check) continue;
    const Eigen::Vector3d map = to_map(p.ecef);
    const Eigen::Vector3d at(map.x() * context.unit, map.y() * context.unit, map.z() * metres_per_transformed_height(context));
    if (p.target.empty()) {
      out.list.push_back({p.name, p.cover, p.place, at, p.sigma_v});
      continue;
    }
    ++out.corners;
    if (out.targets.empty() || out.targets.back().name != p.target) out.targets.push_back({p.target, {}, p.sigma_h});
    out.targets.back().corners.push_back(at);
  }
  return out;
}

/// Of the geoid at the first mark, m.
double undulation_at(const Context& context, const Marks& marks) {
  const auto place = core::place_on_earth(context.crs, marks.list.front().at.head<2>() / context.unit);
  return place ? core::undulation(*place) : std::nan("");
}

std::vector<fs::path> check_files(const io::Survey& survey) {
  std::vector<fs::path> out;
  for (const io::ControlFile& f : survey.control)
    if (holds_check_points(f)) out.push_back(io::resolve(survey, f.file));
  return out;
}

bool has_marks(const io::Survey& survey) { return std::any_of(survey.control.begin(), survey.control.end(), holds_check_points); }

/// A check point file that cannot be used is found before the work begins.
void require_marks(const Context& context, const CheckPointOptions&) {
  if (!has_marks(context.survey)) return;
  io::Survey survey = context.survey;
  if (survey.crs.empty() && context.source) survey.crs = context.source->own_crs(survey);
  if (survey.crs.empty()) return;
  core::Tally of_the_run;
  io::read_control(survey, of_the_run);
}

fs::path readings_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "marks"); }

/// What a tile has at the targets: returns with their beams by the trajectory, or returns and the pulses that show the beams.
struct RoofRows {
  std::vector<quality::RoofReturn> returns;
  std::vector<quality::PulseReturn> pulses;
};

RoofRows roof_rows(const TileJob& job, const Context& context, const trajectory::Trajectory* flown,
                   const std::vector<quality::RoofTarget>& targets, RunCache& cache) {
  std::vector<Box> reaches;
  for (const quality::RoofTarget& t : targets)
    if (quality::is_near(t, job.box)) reaches.push_back(quality::reach_of(t));
  if (reaches.empty()) return {};
  if (flown) return {quality::returns_at_roofs(job.block, job.own, scanner_positions(context, *flown, job.block, cache), targets), {}};
  return {quality::returns_at_roofs(job.block, job.own, {}, targets), quality::pulse_returns_in(job.block, job.own, reaches)};
}

void read_tile(const TileJob& job, const Context& context, const CheckPointOptions& o, const trajectory::Trajectory* flown,
               RunCache& cache) {
  std::vector<quality::MarkReading> readings;
  RoofRows roofs;
  std::vector<SeenCell> seen;
  if (!context.crs.empty()) {
    const Marks& marks = cache.get([&] { return marks_of(context); });
    std::vector<size_t> here;
    for (size_t m = 0; m < marks.list.size(); ++m)
      if (job.box.holds(marks.list[m].at.x(), marks.list[m].at.y())) here.push_back(m);
    readings = quality::read_marks(job.block, marks.list, here, o.radius.value, o.surface);
    roofs = roof_rows(job, context, flown, marks.targets, cache);
    seen = seen_cells(job.block, job.own);
  }
  write_rows(readings_file(job.folder, job.key), readings, roofs.returns, roofs.pulses, seen);
}

void join_readings(const Context&, const TileJob& whole, const std::vector<fs::path>& parts) {
  std::vector<quality::MarkReading> readings;
  RoofRows roofs;
  std::vector<SeenCell> seen;
  for (const fs::path& part : parts) read_rows(readings_file(part, whole.key), readings, roofs.returns, roofs.pulses, seen);
  write_rows(readings_file(whole.folder, whole.key), readings, roofs.returns, roofs.pulses, seen);
}

/// What the readings of its lines say of each mark: differences weighted by their points, of sigma and slope the largest.
void add_readings(const std::vector<quality::MarkReading>& readings, std::vector<MarkFound>& found) {
  std::vector<double> n(found.size(), 0.0);
  for (const quality::MarkReading& r : readings) {
    const auto m = static_cast<size_t>(r.mark);
    MarkFound& f = found[m];
    if (n[m] == 0.0) f.points = f.slope = 0.0;
    f.points += static_cast<double>(r.difference) * r.points;
    n[m] += r.points;
    f.sigma = std::max(f.sigma, static_cast<double>(r.sigma));
    f.sigma_h = std::max(f.sigma_h, static_cast<double>(r.sigma_h));
    f.slope = std::max(f.slope, static_cast<double>(r.slope));
  }
  for (size_t m = 0; m < found.size(); ++m)
    if (n[m] > 0.0) found[m].points /= n[m];
}

/// The terrain model less the check points `here`, which lie in one tile.
void add_model_heights(const Grids& grids, const Marks& marks, const std::vector<size_t>& here, std::vector<MarkFound>& found) {
  constexpr double far = std::numeric_limits<double>::infinity();
  Box box{far, far, -far, -far};
  for (const size_t m : here) {
    const Eigen::Vector3d& at = marks.list[m].at;
    box = {std::min(box.x0, at.x()), std::min(box.y0, at.y()), std::max(box.x1, at.x()), std::max(box.y1, at.y())};
  }
  const double cell = grids.cell(Product::dtm);
  box = box.grown(2.0 * cell);
  const core::Grid model = grids.window(Product::dtm, core::lattice_of(cell, box.x0, box.y0, box.x1, box.y1));
  for (const size_t m : here) {
    const Eigen::Vector3d& at = marks.list[m].at;
    found[m].dtm = report::sample(model, at.x(), at.y()).height - at.z();
  }
}

std::vector<MarkFound> found_at(const Context& context, const Marks& marks, const std::vector<quality::MarkReading>& readings,
                                const std::vector<SeenCell>& seen) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<MarkFound> out(marks.list.size(), MarkFound{none, none, 0.0, 0.0, none, false});
  add_readings(readings, out);
  std::map<TileKey, std::vector<size_t>> by_tile;  // a window reads whole tiles from the disk
  for (size_t m = 0; m < marks.list.size(); ++m) {
    const Eigen::Vector3d& at = marks.list[m].at;
    out[m].is_outside = away(seen, at) > outside_from;
    const auto tile = [&](double v) { return static_cast<int>(std::floor(v / context.tile_side)); };
    if (!out[m].is_outside) by_tile[{tile(at.x()), tile(at.y())}].push_back(m);
  }
  if (!context.grids || !context.grids->has(Product::dtm)) return out;
  for (const auto& [key, here] : by_tile) add_model_heights(*context.grids, marks, here, out);
  return out;
}

std::string shown(const std::vector<std::string>& names) {
  std::string out;
  for (size_t k = 0; k < std::min(names.size(), names_shown); ++k) out += (k ? ", " : "") + names[k];
  return names.size() > names_shown ? out + " and " + std::to_string(names.size() - names_shown) + " more" : out;
}

/// What is wrong with the check points as a whole.
void name_records(const Marks& marks, const std::vector<MarkFound>& at, const std::vector<SeenCell>& seen, CheckPointFindings& found) {
  std::set<std::string> names, twice;
  double nearest = std::numeric_limits<double>::infinity();
  size_t compared = 0;
  for (size_t m = 0; m < marks.list.size(); ++m) {
    const quality::CheckMark& mark = marks.list[m];
    if (!names.insert(mark.name).second) twice.insert(mark.name);
    if (at[m].is_outside) {
      found.outside.push_back(mark.name);
      nearest = std::min(nearest, 1e-3 * away(seen, mark.at));
    } else if (std::isnan(at[m].points)) {
      found.unread.push_back(mark.name);
    }
    compared += !std::isnan(at[m].points) || !std::isnan(at[m].dtm);
  }
  const size_t all = marks.list.size(), outside = found.outside.size();
  char distance[60];
  std::snprintf(distance, sizeof distance, "%.1f km", nearest);
  if (outside == all && all > 0)
    found.named.push_back(
        {"check.outside",
         (all == 1 ? std::string("the only check point does not lie") : "none of the " + std::to_string(all) + " check points lies") +
             " within the survey" + (std::isfinite(nearest) ? std::string(", the nearest is ") + distance + " away" : std::string()) +
             ": compare the CRS and the columns of [[control]] with the survey's"});
  else if (outside > 0)
    found.named.push_back({"check.outside", std::to_string(outside) + " of " + std::to_string(all) +
                                                " check points lie outside the survey's points: " + shown(found.outside)});
  if (!twice.empty())
    found.named.push_back({"check.names", core::counted(twice.size(), "name stands", "names stand") +
                                              " for several check points: " + shown({twice.begin(), twice.end()})});
  if (compared < fewest_marks_judged && (all > 0 || marks.targets.empty()))
    found.named.push_back({"check.few", std::to_string(compared) + " of " + std::to_string(all) +
                                            " check points could be compared, fewer than 3: no accuracy is stated by them"});
}

/// Covers that are neither open by the options nor a known word, with their rows; they count as vegetated.
void name_covers(const Marks& marks, const std::vector<std::string>& open, CheckPointFindings& found) {
  std::map<std::string, std::vector<std::string>> unknown;
  size_t rows = 0;
  for (const quality::CheckMark& m : marks.list)
    if (!m.cover.empty() && !quality::is_open_cover(m.cover, open) && quality::cover_in_english(m.cover).empty())
      unknown[m.cover].push_back(m.place), ++rows;
  if (unknown.empty()) return;
  std::vector<std::string> words;
  for (const auto& [cover, places] : unknown) words.push_back("'" + cover + "' (" + shown(places) + ")");
  found.named.push_back({"check.cover", core::counted(rows, "check point has a cover that is not a known word",
                                                      "check points have covers that are not known words") +
                                            ", counted as vegetated: " + shown(words)});
}

void judge_planimetry(const Marks& marks, RoofRows rows, bool has_trajectory, CheckPointFindings& found) {
  if (marks.targets.empty()) return;
  // The order is that of the tiles and of their parts.
  std::sort(rows.returns.begin(), rows.returns.end(), [](const auto& a, const auto& b) {
    return std::tie(a.target, a.line, a.time, a.number, a.x, a.y) < std::tie(b.target, b.line, b.time, b.number, b.x, b.y);
  });
  std::vector<double> run_sigmas;
  if (!has_trajectory) run_sigmas = quality::find_runs(rows.returns, quality::spans_of(std::move(rows.pulses)), marks.targets);
  if (rows.returns.empty() && !has_trajectory) {
    found.no_planimetry = "there is no trajectory, and near the roofs too few pulses with GPS times and several returns to show the beams";
    return;
  }
  found.beams = has_trajectory ? "trajectory" : "pulses with several returns";
  found.roofs = quality::roof_shifts(marks.targets, rows.returns, run_sigmas);
  found.planimetry = quality::planimetry_of(found.roofs, found.named);
}

void judge_accuracy(const Marks& marks, const std::vector<MarkFound>& at, const CheckPointOptions& o, CheckPointFindings& found) {
  found.accuracy = accuracy_of(marks.list, at, o.open);
  if (const CoverAccuracy* a = judged_accuracy(found.accuracy, "points", open_cover)) found.nva = a->with_marks;
  if (const CoverAccuracy* a = judged_accuracy(found.accuracy, "points", vegetated_cover))
    found.vva = a->with_marks, found.vva_95 = a->errors.q95;
  std::vector<double> sigmas;
  for (const MarkFound& m : at)
    if (m.sigma_h > 0.0) sigmas.push_back(m.sigma_h);
  const CoverAccuracy* heights = judged_accuracy(found.accuracy, "dtm", every_cover);
  found.map = map_class_of(o.map, heights ? heights : judged_accuracy(found.accuracy, "points", every_cover),
                           found.planimetry ? found.planimetry->rmse : std::nullopt, core::median(sigmas, 0.0));
}

CheckPointFindings judge_points(const MergeJob& job, const Context& context, const CheckPointOptions& o,
                                const trajectory::Trajectory* flown, RunCache& cache) {
  CheckPointFindings found;
  if (!has_marks(context.survey)) {
    found.none = "none: the survey has no [[control]] of three coordinates with use = \"check\"";
    return found;
  }
  const Marks& marks = cache.get([&] { return marks_of(context); });
  std::vector<quality::MarkReading> readings;
  RoofRows rows;
  std::vector<SeenCell> seen;
  for (const TileKey key : job.tiles) read_rows(readings_file(job.folder, key), readings, rows.returns, rows.pulses, seen);
  std::sort(readings.begin(), readings.end(),
            [](const auto& a, const auto& b) { return std::pair(a.mark, a.line) < std::pair(b.mark, b.line); });
  const std::vector<MarkFound> at = found_at(context, marks, readings, seen);
  found.files = tables_read(context.survey);
  found.marks = marks.list.size();
  found.corners = marks.corners;
  name_records(marks, at, seen, found);
  if (o.open == CheckPointOptions().open) name_covers(marks, o.open, found);  // a list of one's own says what is open
  judge_planimetry(marks, std::move(rows), flown != nullptr, found);
  judge_accuracy(marks, at, o, found);
  quality::MarkFaults faults = quality::find_faults(marks.list, readings, [&] { return undulation_at(context, marks); });
  found.lines = std::move(faults.lines);
  found.named.insert(found.named.end(), faults.named.begin(), faults.named.end());
  write_marks(context, o.name, marks.list, at, readings);
  core::Value all = core::reported(found);
  core::Value& list = all["check_points_found"] = core::Value::array();
  for (size_t m = 0; m < at.size(); ++m) list.push(core::reported(NamedMark{marks.list[m].name, marks.list[m].cover, at[m]}));
  io::write_text_file(context.output / points_file, io::to_json(all));
  return found;
}

}  // namespace

Entry check_points_stage() {
  return tile<read_tile, judge_points>(
      "quality.points", "Check points against ground points and terrain model: accuracy by cover, and whose fault a difference is.",
      {.columns = {.needs = {Column::classification, Column::flags, Column::strip},
                   .reads = {Column::sigma_v, Column::sigma_h, Column::time, Column::return_number, Column::return_count}},
       .check = require_marks,
       .has_tile_work = has_marks,
       .inputs = check_files,
       .products =
           [](const CheckPointOptions& o) {
             return std::vector<std::string>{o.name + ".csv", o.name + ".gpkg", points_file};
           },
       .join_parts = join_readings});
}

}  // namespace swath::stages
