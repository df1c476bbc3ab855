// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/report_warnings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/config/units.h"
#include "core/printable.h"
#include "core/time.h"
#include "io/las/las_box.h"
#include "io/las/las_ending.h"
#include "pipeline/engine/map_fit.h"
#include "pipeline/limits.h"

namespace swath::pipeline {
namespace {

using core::Value;

constexpr std::string_view box_code = "points.outside_box", damage_code = "work.damaged", geometry_code = "geometry.contradiction",
                           mistake_code = "geometry.mistake", control_code = "control.unused", buildings_code = "buildings.none",
                           contours_code = "contours.short", interval_code = "contours.interval", scale_code = "crs.scale",
                           outside_code = "crs.outside", fixes_code = "trajectory.fixes", noise_code = "trajectory.imu_noise",
                           events_code = "events.outside", sigmas_code = "trajectory.gnss_sigmas", same_file_code = "clouds.same_file",
                           duplicates_code = "clouds.duplicates", unflown_code = "laser.outside_trajectory",
                           no_line_code = "laser.outside_lines", spans_code = "powerlines.none", calibration_code = "calib.finding",
                           memory_code = "run.memory", undeclared_code = "surface.undeclared";
constexpr double contradicting_share = 0.05, least_contradicting = 10.0;  // of the fixes; fixes
constexpr size_t same_files_named = 5;
constexpr double warned_duplicates = 1e-3;                     // of the first returns
constexpr double warned_noise = 30.0;                          // times the stated noise
constexpr double warned_unflown = 0.01, warned_no_line = 0.2;  // of the records; surveys that scan in turns have many outside the lines
constexpr size_t files_named = 3;

/// An example for each file, and one for those that the report counts without.
void add_boxes(const Value& wrong, std::vector<Warning>& out) {
  const auto& examples = wrong.find("examples")->items();
  for (const Value& example : examples) out.push_back({std::string(box_code), example.as_text(), {}});
  const auto more = wrong.find("count")->as_int() - static_cast<std::int64_t>(examples.size());
  if (more > 0)
    out.push_back({std::string(box_code),
                   "and " + std::to_string(more) + " more " + io::wrong_box + ": report.json",
                   {{"more", static_cast<double>(more), {}}}});
}

/// Clouds of the same length and checksum; each is compared with the first of its kind.
void add_same_files(const Value& inputs, std::vector<Warning>& out) {
  std::map<std::pair<std::string, std::int64_t>, std::string> first;
  size_t same = 0;
  for (const Value& input : inputs.items()) {
    const std::string& file = input.find("file")->as_text();
    if (!io::has_las_ending(file)) continue;
    const auto [known, is_new] = first.try_emplace({input.find("xxh3")->as_text(), input.find("bytes")->as_int()}, file);
    if (!is_new && ++same <= same_files_named)
      out.push_back(
          {std::string(same_file_code), file + " holds the same bytes as " + known->second + ": points that it has are there twice", {}});
  }
  if (same > same_files_named)
    out.push_back({std::string(same_file_code),
                   "and " + std::to_string(same - same_files_named) + " more clouds that hold the bytes of another: inputs in report.json",
                   {{"more", static_cast<double>(same - same_files_named), {}}}});
}

void add_crs(const Value& crs, std::vector<Warning>& out) {
  const std::string& name = crs.find("name")->as_text();
  if (const Value* scale = crs.find("scale"); scale && std::abs(scale->as_number() - 1.0) > warned_scale)
    out.push_back({std::string(scale_code), scale_warning(name, scale->as_number()), {{"scale", scale->as_number(), {}}}});
  if (const Value* outside = crs.find("degrees_outside"); outside && outside->as_number() > warned_outside)
    out.push_back({std::string(outside_code), outside_warning(name, outside->as_number()), {{"outside", outside->as_number(), "deg"}}});
}

std::string one_decimal(double v) { return core::format_number(std::round(v * 10) / 10); }

/// "flight1.las: 4120 from 2026-06-07T11:40:06.002Z to 2026-06-07T11:40:31.400Z".
std::string times_by_file(const Value& counted) {
  const Value* files = counted.find("files");
  if (!files) return {};
  std::string out;
  size_t named = 0;
  for (const Value& f : files->items()) {
    if (++named > files_named) return out + "; and " + core::counted(files->items().size() - files_named, "more file") + ": report.json";
    const auto time = [&](const char* key) { return core::utc_text(f.find(key)->as_number()); };
    out += (out.empty() ? ": " : "; ") + f.find("file")->as_text() + ": " + std::to_string(f.find("count")->as_int()) + " from " +
           time("first_s") + " to " + time("last_s");
  }
  return out;
}

/// Records of the laser that neither trajectory nor lines cover, where they are many.
void add_uncovered(const Value& stage, std::vector<Warning>& out) {
  const Value* tally = stage.find("tally");
  const auto add = [&](const char* key, double all, double warned, std::string_view code, const std::string& what) {
    const Value* counted = tally ? tally->find(key) : nullptr;
    const double n = counted ? counted->find("count")->as_number() : 0.0;
    if (!(all > 0.0) || !(n > warned * all)) return;
    out.push_back({std::string(code),
                   core::format_number(n) + " of " + core::format_number(all) + " " + what + " (" + one_decimal(100.0 * n / all) +
                       " %) and are left out" + times_by_file(*counted),
                   {{"share", n / all, {}}, {"records", n, {}}}});
  };
  if (const Value* counts = stage.find("counts"))
    add("outside the trajectory, left out", counts->find("in")->as_number(), warned_unflown, unflown_code,
        "returns lie outside the trajectory or in its gaps");
  const Value* records = stage.find("type")->as_text() == "readers.laser" ? stage.find("records") : nullptr;
  if (!records) return;
  for (const Value& r : records->items())
    if (r.find("name")->as_text() == "records")
      add("records outside every line, left out", r.find("read")->as_number(), warned_no_line, no_line_code,
          "laser records lie outside all flight lines");
}

/// The sentences of what is named are the last ones.
void add_geometry(const Value& geometry, std::vector<Warning>& out) {
  const Value* named = geometry.find("named");
  const auto& sentences = geometry.find("warnings")->items();
  const size_t mistakes = named ? std::min(named->items().size(), sentences.size()) : 0;
  for (size_t k = 0; k < sentences.size(); ++k)
    out.push_back({std::string(k + mistakes < sentences.size() ? geometry_code : mistake_code), sentences[k].as_text(), {}});
}

/// Records that do not fit one another, beyond what outliers and vibration do.
void add_trajectory(const Value& findings, std::vector<Warning>& out) {
  if (const Value* fixes = findings.find("fixes")) {
    const double used = fixes->find("used")->as_number(), contradict = fixes->find("down_weighted")->as_number();
    if (contradict > std::max(least_contradicting, contradicting_share * used))
      out.push_back(
          {std::string(fixes_code),
           core::format_number(contradict) + " of " + core::format_number(used) +
               " fixes contradict the trajectory and are down-weighted: where they follow one another it may be off by far more than its "
               "sigmas",
           {{"contradicting", contradict, {}}, {"fixes", used, {}}}});
  }
  if (const Value* fixes = findings.find("fixes"); fixes && fixes->find("sigmas_overstated"))
    out.push_back(
        {std::string(sigmas_code),
         "the stated sigmas of the GNSS fixes are " + one_decimal(fixes->find("sigmas_overstated")->as_number()) +
             " times too large by their scatter, and the trajectory's sigmas with them, unless the fixes' errors change more slowly than "
             "trajectory.ins_gnss.correlation_time",
         {{"times", fixes->find("sigmas_overstated")->as_number(), {}}}});
  if (const Value* noise = findings.find("imu_noise_factor"); noise && noise->as_number() >= warned_noise)
    out.push_back({std::string(noise_code),
                   "the IMU's records hold " + core::format_number(std::round(noise->as_number())) +
                       " times the stated noise: the trajectory rests on the fixes",
                   {{"factor", noise->as_number(), {}}}});
}

/// Techniques whose events lie outside the record that should cover them; each once, though several stages find it.
void add_events(const Value& techniques, std::set<std::string>& known, std::vector<Warning>& out) {
  for (const Value& one : techniques.items()) {
    if (!known.insert(one.find("technique")->as_text()).second) continue;
    out.push_back({std::string(events_code),
                   one.find("sentence")->as_text(),
                   {{"outside", one.find("outside")->as_number(), {}}, {"events", one.find("events")->as_number(), {}}}});
  }
}

/// `techniques`: those whose events earlier stages named.
void add_findings(const std::string& stage, const Value& findings, std::set<std::string>& techniques, std::vector<Warning>& out) {
  if (stage == "trajectory.ins_gnss") add_trajectory(findings, out);
  if (const Value* outside = findings.find("outside"); outside && (stage == "time.sync" || stage == "trajectory.kinematic"))
    add_events(*outside, techniques, out);
  if (const Value* share = findings.find("duplicate_share"); share && share->as_number() > warned_duplicates)
    out.push_back(
        {std::string(duplicates_code),
         core::format_number(findings.find("duplicates")->as_number()) + " first returns, " + one_decimal(100.0 * share->as_number()) +
             " % of all, share place, time and number with another: they are not counted in the density, but are in every product",
         {{"share", share->as_number(), {}}}});
  const Value *named = findings.find("named"), *returns = findings.find("returns");
  if (named && (stage == "quality.points" || stage == "trajectory.ins_gnss"))
    for (const Value& fault : named->items()) out.push_back({fault.find("code")->as_text(), fault.find("sentence")->as_text(), {}});
  const Value *lines = findings.find("lines"), *left_out = findings.find("left_out");
  if (stage == "terrain.contours" && left_out && lines->as_int() == 0)
    out.push_back({std::string(contours_code),
                   "no contour is written: " +
                       core::counted(left_out->as_int(), "line is shorter than contours.min_length or encloses",
                                     "lines are shorter than contours.min_length or enclose") +
                       " less than contours.min_area",
                   {{"left_out", left_out->as_number(), {}}}});
  if (const Value* said = findings.find("findings"); said && stage.starts_with("calib."))
    for (const Value& sentence : said->items()) out.push_back({std::string(calibration_code), sentence.as_text(), {}});
  if (const Value* undeclared = findings.find("undeclared"); undeclared && stage == "quality.surface")
    out.push_back({std::string(undeclared_code), undeclared->as_text(), {}});
  const Value *map_class = findings.find("map_class"), *said = findings.find("findings");
  if (stage == "terrain.contours" && map_class && map_class->as_text() == "none" && said && !said->items().empty())
    out.push_back(
        {std::string(interval_code), said->items().front().as_text(), {{"model_sigma", findings.find("model_sigma_m")->as_number(), "m"}}});
  if (const Value* spans = findings.find("spans"); stage == "terrain.powerlines" && spans && spans->as_int() == 0)
    out.push_back(
        {std::string(spans_code),
         "terrain.powerlines found no span in " + core::counted(findings.find("unused_wire_returns")->as_int(), "return", "returns") +
             " of wires (14): filters.classify looks for no wire below its wire_height, and spans shorter than min_span are left out",
         {{"wire_returns", findings.find("unused_wire_returns")->as_number(), {}}}});
  if (stage == "terrain.buildings" && returns && returns->as_int() == 0)
    out.push_back({std::string(buildings_code), "no return is of class building (6): terrain.buildings found nothing", {}});
}

}  // namespace

std::vector<Warning> warnings_in(const Value& report) {
  std::vector<Warning> out;
  if (const Value* crs = report.find("crs")) add_crs(*crs, out);
  if (const Value* damaged = report.find("pieces_damaged"); damaged && damaged->as_int() > 0)
    out.push_back({std::string(damage_code),
                   core::counted(damaged->as_int(), "piece of an earlier run was damaged and was done again",
                                 "pieces of an earlier run were damaged and were done again"),
                   {{"pieces", damaged->as_number(), {}}}});
  if (const Value* inputs = report.find("inputs")) add_same_files(*inputs, out);
  for (const Value& stage : report.find("stages")->items()) add_uncovered(stage, out);
  for (const Value& stage : report.find("stages")->items())
    if (const Value* tally = stage.find("tally"))
      if (const Value* wrong = tally->find(io::wrong_box)) add_boxes(*wrong, out);
  std::set<std::string> techniques;
  for (const Value& stage : report.find("stages")->items())
    if (const Value* findings = stage.find("findings")) add_findings(stage.find("type")->as_text(), *findings, techniques, out);
  if (const Value* unused = report.find("control_unused"))
    for (const Value& file : unused->items())
      out.push_back({std::string(control_code), "[[control]] " + file.as_text() + " is used by no stage of this run", {}});
  if (const Value* over = report.find("over_memory"))
    for (const Value& stage : over->items()) out.push_back({std::string(memory_code), stage.as_text(), {}});
  if (const Value* geometry = report.find("geometry")) add_geometry(*geometry, out);
  if (const Value* limits = report.find("limits"))
    for (Warning& w : missed_limits(*limits, report.find("stages"))) out.push_back(std::move(w));
  return out;
}

}  // namespace swath::pipeline
