// SPDX-License-Identifier: GPL-3.0-or-later
// The survey's point clouds on the map of a run.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/area.h"
#include "core/geo/crs.h"
#include "io/las/cloud_extent.h"
#include "io/las/las_reader.h"
#include "io/las/las_source.h"
#include "io/survey/survey.h"

namespace swath::io {

/// The map that clouds are brought to. It must outlive the use of it.
struct CloudMap {
  const core::Crs& crs;
  double unit = 1.0, vertical_unit = 1.0;  ///< metres per unit of the CRS, of its heights
  Eigen::Vector3d origin;                  ///< of blocks, m
  const core::Area& area;                  ///< what lies outside is left out
};

/// The files of the survey's clouds, in its order.
std::vector<LasSource> cloud_sources(const Survey& survey, const CloudMap& map);

/// Do all files state the CRS of the map themselves, in units of theirs?
bool keeps_crs(const std::vector<LasSource>& sources, const core::Crs& map);

/// Are the clouds' times seconds of a week that neither file nor survey names? Throws core::Error where only some of the files' times are.
bool has_weekless_times(const Survey& survey);

/// Streams a point cloud in map coordinates, converted to the CRS and metres of the run.
class CloudSource {
 public:
  /// `cloud`: number in the survey's points; `rim`: largest coordinates of the survey's files; `extent`: of this one; `part`: of its
  /// points.
  CloudSource(const Survey& survey, size_t cloud, const CloudMap& map, const Eigen::Vector2d& rim, const CloudExtent& extent,
              const LasPart& part = {});
  /// False at the end.
  bool next(core::Block& out, size_t most, core::Tally& tally);

 private:
  void keep_near(core::Block& block, core::Tally& tally);
  void set_unknown_times(core::Block& block, core::Tally& tally) const;
  void convert(core::Block& block, core::Tally& tally);

  const PointFile& file_;
  std::uint32_t number_;  ///< from 1; 0: records are not kept
  CloudMap map_;
  LasReader reader_;
  Eigen::Vector2d rim_;
  const CloudExtent& extent_;
  std::optional<core::Transform> transform_;  ///< from the file's CRS, where it is another
  double file_height_unit_ = 1.0;             ///< of the map's vertical unit, or metres where there is a transformation
  double map_height_unit_ = 1.0;
  LasTime time_;
  bool has_unknown_times_ = false;
  std::uint64_t far_ = 0;  ///< points far from the others so far
};

}  // namespace swath::io
