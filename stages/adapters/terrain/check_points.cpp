// SPDX-License-Identifier: GPL-3.0-or-later
// Check points against the ground points and the terrain model: accuracy by cover, and whose fault a difference is.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/statistics.h"
#include "io/text/output_file.h"
#include "io/vector/control.h"
#include "quality/mark_faults.h"
#include "report/statistics.h"
#include "report/volumes.h"
#include "stages/adapters/adapters.h"
#include "stages/tile.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

constexpr std::uint64_t enough_marks = 30;  // ASPRS 2024: fewer make no statement of accuracy

struct CheckPointOptions {
  std::string name = "check_points";
  core::Metres radius{1.0};
  quality::MarkSurface surface = quality::MarkSurface::plane;
  std::vector<std::string> open{"", "open", "bare", "urban", "NVA"};
};

template <class V>
void describe(CheckPointOptions& o, V& v) {
  v.option("name", o.name, "Name of the table of all check points: NAME.csv.");
  v.option("radius", o.radius, core::above_to(0.0, 20.0), "Ground points within this distance of a check point are compared with it.");
  v.option("surface", o.surface, "plane: through the ground points, at the check point; mean: of their heights.");
  v.option("open", o.open, "Covers that count as not vegetated; \"\": none stated.");
}

double halo(const CheckPointOptions& o) { return o.radius.value; }

/// Accuracy of one product on one kind of cover.
struct CoverAccuracy {
  std::string product, cover;
  report::Statistics errors;
  double q90 = std::nan(""), marks_sigma = 0.0, with_marks = 0.0, without_marks = 0.0;
  bool is_enough = false;
};

template <class V>
void describe(const CoverAccuracy& a, V& v) {
  v.result("product", a.product, "points: ground points around the check point; dtm: the terrain model.");
  v.result("cover", a.cover, "open (NVA), vegetated (VVA), or one cover as stated.");
  describe(a.errors, v);
  v.result("q90", a.q90, "90 % of the absolute values are smaller.");
  v.result("sigma_of_marks_m", a.marks_sigma, core::metres(), "Sigma of the check points' heights, rms.");
  v.result("rmse_with_marks_m", a.with_marks, core::metres().in_summary(), "RMSE with the check points' own error added (ASPRS 2024).");
  v.result("without_marks_m", a.without_marks, core::metres(), "RMSE with it taken off (Brandalize (16)); negative: it explains more.");
  v.result("is_enough", a.is_enough, "There are 30 check points or more: fewer make no statement of accuracy.");
}

struct CheckPointFindings {
  std::optional<std::string> none{};
  std::uint64_t marks = 0;
  std::vector<std::string> unread{};
  std::vector<CoverAccuracy> accuracy{};
  std::vector<quality::LineAtMarks> lines{};
  std::vector<quality::NamedFault> named{};
};

template <class V>
void describe(const CheckPointFindings& r, V& v) {
  v.result("check_points", r.none, core::plain().in_summary(), "Why nothing was compared.");
  v.result("marks", r.marks, core::plain().only_if(!r.none), "Check points of the survey.");
  v.result("unread", r.unread, core::plain().only_if(!r.unread.empty()), "Check points without ground points around them.");
  v.tables("accuracy", r.accuracy, "Errors by product and cover.");
  v.tables("lines", r.lines, "Flight lines against the check points that they show.");
  v.tables("named", r.named, "Whose fault the largest differences are.");
}

struct Marks {
  std::vector<quality::CheckMark> list;
};

Marks marks_of(const Context& context) {
  Marks out;
  core::Tally of_others;
  const core::Transform to_map(core::wgs84_ecef(), context.crs);
  for (const io::ControlPoint& p : io::read_control(context.survey, of_others)) {
    if (p.use != io::ControlUse::check || !p.target.empty()) continue;
    const Eigen::Vector3d map = to_map(p.ecef);
    out.list.push_back(
        {p.name, p.cover, p.place, {map.x() * context.unit, map.y() * context.unit, map.z() * context.vertical_unit}, p.sigma_v});
  }
  return out;
}

bool has_marks(const io::Survey& survey) {
  return std::any_of(survey.control.begin(), survey.control.end(), [](const io::ControlFile& f) { return f.use == io::ControlUse::check; });
}

fs::path readings_file(const fs::path& folder, TileKey key) { return piece_file(folder, key, "marks"); }

void read_tile(const TileJob& job, const Context& context, const CheckPointOptions& o, RunCache& cache) {
  std::vector<quality::MarkReading> readings;
  if (has_marks(context.survey) && !context.crs.empty()) {
    const Marks& marks = cache.get([&] { return marks_of(context); });
    std::vector<size_t> here;
    for (size_t m = 0; m < marks.list.size(); ++m)
      if (job.box.holds(marks.list[m].at.x(), marks.list[m].at.y())) here.push_back(m);
    readings = quality::read_marks(job.block, marks.list, here, o.radius.value, o.surface);
  }
  write_rows(readings_file(job.folder, job.key), readings);
}

/// Differences at each mark; NaN where there is none.
struct Differences {
  std::vector<double> points, dtm;
};

Differences differences_of(const Context& context, const Marks& marks, const std::vector<quality::MarkReading>& readings) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  Differences out{std::vector<double>(marks.list.size(), none), std::vector<double>(marks.list.size(), none)};
  std::vector<double> sum(marks.list.size(), 0.0), n(marks.list.size(), 0.0);
  for (const quality::MarkReading& r : readings) {
    sum[static_cast<size_t>(r.mark)] += static_cast<double>(r.difference) * r.points;
    n[static_cast<size_t>(r.mark)] += r.points;
  }
  const bool has_dtm = context.grids && context.grids->has(Product::dtm);
  for (size_t m = 0; m < marks.list.size(); ++m) {
    if (n[m] > 0.0) out.points[m] = sum[m] / n[m];
    if (!has_dtm) continue;
    const Eigen::Vector3d& at = marks.list[m].at;
    const double cell = context.grids->cell(Product::dtm);
    const core::Grid around = context.grids->window(
        Product::dtm, core::lattice_of(cell, at.x() - 2 * cell, at.y() - 2 * cell, at.x() + 2 * cell, at.y() + 2 * cell));
    out.dtm[m] = report::sample(around, at.x(), at.y()).height - at.z();
  }
  return out;
}

CoverAccuracy accuracy_of(const std::string& product, const std::string& cover, const std::vector<double>& errors,
                          const std::vector<double>& sigmas) {
  CoverAccuracy a{product, cover, report::statistics(errors)};
  std::vector<double> sizes;
  double squares = 0.0;
  for (size_t k = 0; k < errors.size(); ++k) {
    sizes.push_back(std::abs(errors[k]));
    squares += sigmas[k] * sigmas[k];
  }
  a.q90 = core::quantile(sizes, 0.9);
  a.marks_sigma = std::sqrt(squares / static_cast<double>(errors.size()));
  a.with_marks = std::hypot(a.errors.rms, a.marks_sigma);
  const double rest = a.errors.rms * a.errors.rms - a.marks_sigma * a.marks_sigma;
  a.without_marks = std::copysign(std::sqrt(std::abs(rest)), rest);
  a.is_enough = a.errors.n >= enough_marks;
  return a;
}

/// Open and vegetated ground, and each cover that the survey states.
void add_accuracy(const std::string& product, const Marks& marks, const std::vector<double>& errors, const CheckPointOptions& o,
                  std::vector<CoverAccuracy>& out) {
  std::map<std::string, std::pair<std::vector<double>, std::vector<double>>> groups;
  for (size_t m = 0; m < errors.size(); ++m) {
    if (std::isnan(errors[m])) continue;
    const std::string& cover = marks.list[m].cover;
    const bool is_open = std::find(o.open.begin(), o.open.end(), cover) != o.open.end();
    std::vector<std::string> kinds{is_open ? "open (NVA)" : "vegetated (VVA)"};
    if (!cover.empty()) kinds.push_back(cover);
    for (const std::string& kind : kinds) {
      groups[kind].first.push_back(errors[m]);
      groups[kind].second.push_back(marks.list[m].sigma);
    }
  }
  for (const auto& [kind, group] : groups) out.push_back(accuracy_of(product, kind, group.first, group.second));
}

std::string table_of(const Context& context, const Marks& marks, const Differences& d, const std::vector<quality::MarkReading>& readings) {
  std::string out = "name,x,y,z,sigma,cover,points_minus_mark,dtm_minus_mark,slope,lines\n";
  char text[200];
  for (size_t m = 0; m < marks.list.size(); ++m) {
    const quality::CheckMark& mark = marks.list[m];
    std::snprintf(text, sizeof text, ",%.3f,%.3f,%.3f,%.4f,", mark.at.x() / context.unit, mark.at.y() / context.unit,
                  mark.at.z() / context.vertical_unit, mark.sigma);
    out += mark.name + text + mark.cover + ",";
    const auto number = [&](double v) {
      if (std::isfinite(v)) {
        std::snprintf(text, sizeof text, "%.4f", v);
        out += text;
      }
      out += ",";
    };
    number(d.points[m]);
    number(d.dtm[m]);
    double slope = std::nan("");
    std::string lines;
    for (const quality::MarkReading& r : readings) {
      if (static_cast<size_t>(r.mark) != m) continue;
      slope = std::isnan(slope) ? static_cast<double>(r.slope) : std::max(slope, static_cast<double>(r.slope));
      std::snprintf(text, sizeof text, "%s%d:%.4f", lines.empty() ? "" : " ", r.line, static_cast<double>(r.difference));
      lines += text;
    }
    number(slope);
    out += lines + "\n";
  }
  return out;
}

CheckPointFindings judge_points(const MergeJob& job, const Context& context, const CheckPointOptions& o, RunCache& cache) {
  CheckPointFindings found;
  if (!has_marks(context.survey)) {
    found.none = "none: the survey has no [[control]] with use = \"check\"";
    return found;
  }
  const Marks& marks = cache.get([&] { return marks_of(context); });
  std::vector<quality::MarkReading> readings;
  for (const TileKey key : job.tiles) read_rows(readings_file(job.folder, key), readings);
  std::sort(readings.begin(), readings.end(),
            [](const auto& a, const auto& b) { return std::pair(a.mark, a.line) < std::pair(b.mark, b.line); });
  const Differences d = differences_of(context, marks, readings);
  found.marks = marks.list.size();
  for (size_t m = 0; m < marks.list.size(); ++m)
    if (std::isnan(d.points[m])) found.unread.push_back(marks.list[m].name);
  add_accuracy("points", marks, d.points, o, found.accuracy);
  add_accuracy("dtm", marks, d.dtm, o, found.accuracy);
  quality::MarkFaults faults = quality::find_faults(marks.list, readings);
  found.lines = std::move(faults.lines);
  found.named = std::move(faults.named);
  io::write_text_file(context.output / (o.name + ".csv"), table_of(context, marks, d, readings));
  return found;
}

}  // namespace

Entry check_points_stage() {
  return tile<read_tile, judge_points>(
      "quality.points", "Check points against ground points and terrain model: accuracy by cover, and whose fault a difference is.",
      {.columns = {.needs = {Column::classification, Column::flags, Column::strip}, .reads = {Column::sigma_v}},
       .inputs = files_in<&io::Survey::control>,
       .products = [](const CheckPointOptions& o) { return std::vector<std::string>{o.name + ".csv"}; }});
}

}  // namespace swath::stages
