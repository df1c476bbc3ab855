// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/proj_grids.h"

#include <set>

#include "core/geo/proj_handles.h"

namespace swath::core {
namespace {

void add_grids(PJ_CONTEXT* c, const PJ* operation, std::set<std::filesystem::path>& to) {
  for (int i = 0; i < proj_coordoperation_get_grid_used_count(c, operation); ++i) {
    const char* full = nullptr;
    if (!proj_coordoperation_get_grid_used(c, operation, i, nullptr, &full, nullptr, nullptr, nullptr, nullptr, nullptr)) continue;
    std::error_code ec;
    if (const std::filesystem::path file = proj_text(full); std::filesystem::is_regular_file(file, ec)) to.insert(file);
  }
}

}  // namespace

std::vector<std::filesystem::path> grid_files_between(const Crs& from, const Crs& to) {
  if (from.empty() || to.empty()) return {};
  const ProjContext context = new_proj_context();
  PJ_CONTEXT* c = context.get();
  const Pj source = three_dimensional(c, from.facts()), target = three_dimensional(c, to.facts());
  if (!source || !target) return {};
  const PjFactory f(proj_create_operation_factory_context(c, nullptr));
  proj_operation_factory_context_set_spatial_criterion(c, f.get(), PROJ_SPATIAL_CRITERION_PARTIAL_INTERSECTION);
  proj_operation_factory_context_set_use_proj_alternative_grid_names(c, f.get(), 1);
  const PjList list(proj_create_operations(c, source.get(), target.get(), f.get()));
  std::set<std::filesystem::path> out;
  for (int i = 0; list && i < proj_list_get_count(list.get()); ++i) {
    const Pj operation(proj_list_get(c, list.get(), i));
    if (operation) add_grids(c, operation.get(), out);
  }
  return {out.begin(), out.end()};
}

void use_proj_folders(const std::vector<std::filesystem::path>& folders) {
  std::vector<const char*> names;
  for (const std::filesystem::path& folder : folders)
    if (!folder.empty()) names.push_back(folder.c_str());
  // Of the default context, which all others are copied from.
  proj_context_set_search_paths(nullptr, static_cast<int>(names.size()), names.data());
}

}  // namespace swath::core
