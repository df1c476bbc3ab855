// SPDX-License-Identifier: GPL-3.0-or-later
// `swath volumes`: cut and fill between two terrain models, or from one to a design height.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "report/volumes.h"

namespace swath::pipeline {

struct VolumeRequest {
  std::filesystem::path before, after;  ///< rasters; `after` empty where a design height stands for it
  std::optional<double> design;         ///< unit of the heights of `before`
  std::filesystem::path polygon;        ///< vector file with rings, or empty
  double correlation = 1.0;             ///< of the errors of any two cells of a model
};

/// Volumes in m3, areas in m2; without a CRS in units of the file.
struct VolumesFound {
  VolumeRequest request;
  std::uint64_t vertices_left_out = 0;  ///< of the polygon
  bool has_crs = false;
  double cell = 0.0;
  report::Volumes volumes;  ///< in the units above
  std::uint64_t impossible_heights = 0;
  std::vector<std::string> notes = {};  ///< what was taken for granted, sentences
};

template <class V>
void describe(const VolumesFound& f, V& v) {
  const VolumeRequest& r = f.request;
  const report::Volumes& s = f.volumes;
  const bool has_sigma = std::isfinite(s.sigma_net);
  v.result("before", r.before, "The surface before.");
  v.result("design_height", r.design, "The height in place of the surface after.");
  v.result("after", r.after, core::plain().only_if(!r.design), "The surface after.");
  v.result("polygon", r.polygon, core::plain().only_if(!r.polygon.empty()), "What was counted within.");
  v.result("polygon_vertices_left_out", f.vertices_left_out, core::if_any(), "Vertices that are not finite or beyond every map.");
  v.result("units", std::string_view(f.has_crs ? "m" : "those of the file, which states no CRS"),
           "Unit of lengths; areas in its square, volumes in its cube.");
  v.result("cell", f.cell, "Side of the cells.");
  v.result("cut", s.cut, "Volume below the surface before.");
  v.result("fill", s.fill, "Volume above it.");
  v.result("net", s.net, "Fill less cut.");
  v.result("area", s.area, "Area compared.");
  v.result("cut_area", s.cut_area, "Area lowered.");
  v.result("fill_area", s.fill_area, "Area raised.");
  v.result("correlation", r.correlation, "Correlation of the errors of any two cells of a model.");
  v.result("sigma_cut", s.sigma_cut, core::plain().only_if(has_sigma), "Standard deviation of the cut.");
  v.result("sigma_fill", s.sigma_fill, core::plain().only_if(has_sigma), "Standard deviation of the fill.");
  v.result("sigma_net", s.sigma_net, core::plain().only_if(has_sigma), "Standard deviation of the net volume.");
  v.result("cells", s.cells, "Cells compared.");
  v.result("cells_left_out", s.left_out, "Cells where a surface is void.");
  v.result("area_left_out", s.area_left_out, "Their area.");
  v.result("impossible_heights", f.impossible_heights, core::if_any(), "Heights of the rasters that no ground has, taken as void.");
  v.result("notes", f.notes, core::plain().only_if(!f.notes.empty()), "What was taken for granted.");
}

/// Volumes in m3, areas in m2 (units of the file where it states no CRS), with sigma where both models have it. Surfaces on different
/// lattices are compared on the finer one. Throws core::Error: files that cannot be read, CRSs that differ, no cell in common.
VolumesFound volumes_of(const VolumeRequest& request);
std::string volume_text(const VolumesFound& found);
/// Its notes, a line each.
std::string note_text(const VolumesFound& found);

}  // namespace swath::pipeline
