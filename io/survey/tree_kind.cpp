// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/tree_kind.h"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>

#include "core/error.h"

namespace swath::io {
namespace {

struct KindText {
  std::string_view name, use;
};

constexpr std::array<KindText, 13> texts{{
    {"", ""},
    {"a pipeline", "swath run FILE --survey survey.toml"},
    {"a survey", "swath run CONFIG --survey FILE"},
    {"a hangar survey", "a survey.toml names it, hangar = \"FILE\"; then swath run lever_arm --survey survey.toml"},
    {"a list of tasks", "swath task ID --tasks FILE"},
    {"the report of a run", "swath info FILE"},
    {"a calibration", "a survey.toml names it, calibration_file = \"FILE\""},
    {"a flight plan", "swath plan FILE"},
    {"a block of images", "swath block FILE"},
    {"the accuracy of a block", "swath block-theory FILE"},
    {"a simulation", "swath simulate FOLDER --config FILE"},
    {"an Entwine point tile", "a cloud like any other: swath dtm FOLDER, or [[points]] file = \"FILE\""},
    {"a planned flight", "made by swath plan; simulate.json beside it: swath simulate FOLDER --config simulate.json"},
}};

bool has_any(const core::Value& tree, std::initializer_list<const char*> keys) {
  return std::any_of(keys.begin(), keys.end(), [&](const char* key) { return tree.find(key) != nullptr; });
}

/// By keys that no other kind has; [imu] and [gnss] are tables of simulations.
bool is_surely_survey(const core::Value& tree) {
  const auto has_list = [&](const char* key) { return tree.find(key) && tree.find(key)->is_array(); };
  return has_any(tree, {"laser", "trajectory", "points", "event", "rinex", "hangar"}) || has_list("imu") || has_list("gnss");
}

}  // namespace

TreeKind kind_of(const core::Value& tree) {
  const auto has = [&](const char* key) { return tree.find(key) != nullptr; };
  if (has("hierarchyType") && has("schema")) return TreeKind::entwine;
  if (has("tasks") && has("fingerprint")) return TreeKind::tasks;
  if (has("program") && has("stages")) return TreeKind::report;
  if (has("stage")) return TreeKind::pipeline;
  // Products whose tables are named as those of surveys are.
  if (has("calibration") && has("sigma") && has("verdict")) return TreeKind::calibration;
  if (has("direction_deg") && has("line_length_m") && has("lines")) return TreeKind::planned_flight;
  if (is_surely_survey(tree)) return TreeKind::survey;
  if (has("calibration") && has("sigma") && !has_any(tree, {"imu", "gnss", "crs"})) return TreeKind::calibration;
  if (has("point") && has_any(tree, {"station", "target", "angle"})) return TreeKind::hangar;
  if (has("flight") && has("sensor")) return TreeKind::flight_plan;
  if (has("image_points") && has("images")) return TreeKind::block;
  if (has("sigma_image")) return TreeKind::block_theory;
  if (has_any(tree, {"world", "noise"})) return TreeKind::simulation;
  if (has_any(tree, {"imu", "gnss", "crs", "scanner"})) return TreeKind::survey;
  return TreeKind::other;
}

std::string_view name_of(TreeKind kind) { return texts[static_cast<size_t>(kind)].name; }

std::string_view format_of(TreeKind kind) {
  const std::string_view name = name_of(kind);
  return name.empty() ? "JSON or TOML" : name.substr(name.find(' ') + 1);
}

TreeKind kind_of_format(std::string_view format) {
  for (size_t k = 1; k < texts.size(); ++k)
    if (format_of(static_cast<TreeKind>(k)) == format) return static_cast<TreeKind>(k);
  return TreeKind::other;
}

std::string_view use_of(TreeKind kind) { return texts[static_cast<size_t>(kind)].use; }

void require_kind(const core::Value& tree, TreeKind wanted, const std::filesystem::path& file) {
  const TreeKind kind = kind_of(tree);
  if (kind == TreeKind::other || kind == wanted || (kind == TreeKind::survey && !is_surely_survey(tree))) return;
  throw core::usage_error("it is " + std::string(name_of(kind)) + ", not " + std::string(name_of(wanted)), file.string(),
                          "its use: " + std::string(use_of(kind)));
}

}  // namespace swath::io
