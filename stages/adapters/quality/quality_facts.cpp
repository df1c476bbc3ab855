// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/adapters/quality/quality_facts.h"

#include <algorithm>
#include <cmath>

#include "core/geo/height_unit.h"
#include "io/text/value_file.h"

namespace swath::stages {
namespace {

Facts facts_in(const Context& context, const char* file) {
  const std::filesystem::path made = context.made(file);
  return made.empty() ? Facts() : Facts(io::read_value_file(made));
}

quality::QualityLevel level_of(const std::string& name) {
  const auto& names = core::Choices<quality::QualityLevel>::names;
  const auto at = std::find(names.begin(), names.end(), name);
  return at == names.end() ? quality::QualityLevel::none : static_cast<quality::QualityLevel>(at - names.begin());
}

quality::MeasuredQuality measured_in(const QualityFacts& f) {
  quality::MeasuredQuality m;
  m.spacing = f.density.known("spacing_m");
  m.density = f.density.known("density");
  m.even = f.swath.known("even");
  m.void_area = f.swath.known("void_m2");
  m.intraswath = f.swath.known("hard_m");
  m.interswath = f.swath.known("overlap_rms_m");
  m.nva = f.points.known("nva_m");
  m.vva = f.points.known("vva_95_m");
  return m;
}

std::vector<std::string> gaps_in(const QualityFacts& f) {
  std::vector<std::string> out;
  if (!f.density.any()) out.push_back("Density: quality.density did not run.");
  if (!f.swath.any()) out.push_back("Overlaps, distribution and voids: quality.swath did not run.");
  if (const std::string why = f.swath.text("no_voids"); !why.empty()) out.push_back("Distribution and voids: " + why + ".");
  if (f.swath.any() && f.swath.number("overlap_cells") == 0.0) out.push_back("Overlaps: no two lines see the same smooth level ground.");
  if (!f.points.any()) out.push_back("Accuracy: the survey has no check points ([[control]] with use = \"check\").");
  if (f.points.any() && !f.points.known("nva_m")) out.push_back("NVA: fewer than three check points on open ground could be compared.");
  if (f.points.any() && !f.points.known("vva_m")) out.push_back("VVA: fewer than three check points under vegetation could be compared.");
  if (f.points.any() && !f.points.table("planimetry").known("rmse_m")) {
    const std::string why = f.points.text("no_planimetry");
    out.push_back("Horizontal accuracy: " +
                  (why.empty() ? "fewer than three surveyed roofs (check targets) could be compared." : why + "."));
  }
  if (!f.surface.any()) out.push_back("Terrain model: quality.surface has no reference.");
  for (const std::string& sentence : f.lines.texts("not_shown")) out.push_back(sentence);
  return out;
}

}  // namespace

std::optional<double> Facts::known(std::string_view key) const {
  const core::Value* v = any() ? value_.find(key) : nullptr;
  return v && v->is_number() && std::isfinite(v->as_number()) ? std::optional(v->as_number()) : std::nullopt;
}
double Facts::number(std::string_view key) const { return known(key).value_or(std::nan("")); }
std::string Facts::text(std::string_view key) const {
  const core::Value* v = any() ? value_.find(key) : nullptr;
  return v && v->is_text() ? v->as_text() : std::string();
}
bool Facts::holds(std::string_view key) const {
  const core::Value* v = any() ? value_.find(key) : nullptr;
  return v && v->is_bool() && v->as_bool();
}
std::vector<Facts> Facts::list(std::string_view key) const {
  std::vector<Facts> out;
  if (const core::Value* v = any() ? value_.find(key) : nullptr; v && v->is_array())
    for (const core::Value& one : v->items()) out.emplace_back(one);
  return out;
}
Facts Facts::table(std::string_view key) const {
  const core::Value* v = any() ? value_.find(key) : nullptr;
  return v ? Facts(*v) : Facts();
}
std::vector<double> Facts::numbers(std::string_view key) const {
  std::vector<double> out;
  if (const core::Value* v = any() ? value_.find(key) : nullptr; v && v->is_array())
    for (const core::Value& one : v->items()) out.push_back(one.is_number() ? one.as_number() : std::nan(""));
  return out;
}
std::vector<std::string> Facts::texts(std::string_view key) const {
  std::vector<std::string> out;
  if (const core::Value* v = any() ? value_.find(key) : nullptr; v && v->is_array())
    for (const core::Value& one : v->items()) out.push_back(one.as_text());
  return out;
}

size_t QualityFacts::missed() const {
  return static_cast<size_t>(std::count_if(requirements.begin(), requirements.end(), [](const auto& r) { return r.is_missed(); }));
}
size_t QualityFacts::judged() const {
  return static_cast<size_t>(std::count_if(requirements.begin(), requirements.end(), [](const auto& r) { return r.value.has_value(); }));
}

QualityFacts quality_facts(const Context& context, const quality::StatedLimits& stated) {
  QualityFacts f;
  f.survey = context.survey.name;
  f.crs = context.crs.empty() ? "" : context.crs.name();
  f.heights = context.heights;
  f.metres = context.unit;
  f.unit = core::unit_symbol(context.unit);
  f.density = facts_in(context, "density.json");
  f.swath = facts_in(context, "swath.json");
  f.lines = facts_in(context, "lines.json");
  f.surface = facts_in(context, "surface.json");
  f.points = facts_in(context, "check_points.json");
  if (f.swath.any()) f.level = f.swath.text("quality_level");
  f.requirements = quality::judge_level(level_of(f.level), stated, measured_in(f));
  f.not_judged = gaps_in(f);
  f.density_map = context.made("swath_density.png");
  f.overlap_map = context.made("overlap_dz.png");
  f.distribution_map = context.made("spatial_distribution.png");
  f.surface_map = context.made("surface_difference.png");
  return f;
}

}  // namespace swath::stages
