// SPDX-License-Identifier: GPL-3.0-or-later
// What a page shows: the products of a run, or clouds alone, made small enough for a browser.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/config/value.h"
#include "core/geo/crs.h"
#include "core/on_progress.h"
#include "tools/view/cloud_sample.h"
#include "tools/view/packed.h"

namespace swath::tools {

struct SceneOptions {
  std::uint64_t points = 1000000;      ///< at most about as many
  int terrain_side = 1024;             ///< cells along the longer side of the terrain model
  std::size_t line_vertices = 300000;  ///< of the contours
  bool streams = false;                ///< the page reads the clouds itself and shows more and more of their points
};

/// The files that are shown of a folder; empty where it has none of a kind.
struct ProductFiles {
  std::filesystem::path folder;  ///< empty where clouds alone were given
  std::vector<std::filesystem::path> clouds;
  std::filesystem::path terrain, contours, trajectory, report;
};

struct Scene {
  std::string title, about;
  std::string report;  ///< HTML, all texts of files escaped
  core::Value table = core::Value::object();
  std::vector<Blob> blobs;
};

/// The products of an output folder, or the clouds that are given. Throws core::Error where there is nothing to show.
ProductFiles products_of(const std::vector<std::filesystem::path>& given);

/// Reads and packs them. Throws core::Error where no page can show the CRS, before points are read.
Scene make_scene(const ProductFiles& files, const SceneOptions& options, const core::OnProgress& progress);

// The parts of the scene, put into its table and blobs.

void add_points(Scene& scene, CloudSources clouds, const SceneOptions& options, const core::OnProgress& progress);
void add_terrain(Scene& scene, const std::filesystem::path& file, const SceneOptions& options);
void add_contours(Scene& scene, const std::filesystem::path& file, const SceneOptions& options);
/// Throws core::Error where its positions have no way to the CRS.
void add_trajectory(Scene& scene, const std::filesystem::path& file, const core::Crs& crs);
/// What the page says of the run; `notes`: what could not be shown.
void add_report(Scene& scene, const ProductFiles& files, const std::vector<std::string>& notes);

}  // namespace swath::tools
