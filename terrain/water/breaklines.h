// SPDX-License-Identifier: GPL-3.0-or-later
// What breaklines, water and boundaries do to a terrain model.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "core/block.h"
#include "core/breakline.h"
#include "core/config/option.h"
#include "core/grid.h"
#include "terrain/tin/tin.h"
#include "terrain/water/area.h"
#include "terrain/water/line_network.h"
#include "terrain/water/water.h"

namespace swath::terrain {

struct BreaklineOptions {
  NetworkOptions network;
  core::Metres buffer{0.5};
  WaterOptions water;
};

template <class V>
void describe(BreaklineOptions& o, V& v) {
  describe(o.network, v);
  v.option("buffer", o.buffer, core::at_least(0.0),
           "Ground points closer to a line than this are left out of the model: they make steep slivers.", "Heidemann2018");
  describe(o.water, v);
}

/// A feature whose heights are settled.
struct SettledLine {
  core::Breakline line;
  bool derived = false;  ///< its heights come from points and yield to surveyed ones
};

/// All features of a survey made ready for any tile: one network of constraints, water surfaces, boundaries. Frame: that of `origin`.
class Breaklines {
 public:
  Breaklines() = default;
  /// Throws core::Error where surveyed lines meet at different heights (terrain/water/line_network.h).
  Breaklines(const std::vector<SettledLine>& lines, const BreaklineOptions& options, const Eigen::Vector3d& origin);

  const Constraints& network() const { return network_; }
  /// The part of the network that comes within `reach` (m) of a window.
  Constraints near(const core::Lattice& window, double reach) const;
  /// The rows that stay terrain: outside water and not within the buffer of a line of `near`.
  std::vector<std::uint32_t> kept(const core::Block& block, const std::vector<std::uint32_t>& rows, const Constraints& near) const;
  /// Water: the height and sigma of its surface, reason none; where that is not known no height, reason water. Outside all boundaries
  /// (where there are any): no height, reason no_data.
  void apply(core::Grid& grid) const;
  /// Is the place in a lake or river, whether its height is known or not? Map frame, m.
  bool is_water(double x, double y) const;
  /// Does a box (map frame, m) meet the box around one?
  bool any_water(double x0, double y0, double x1, double y1) const;
  /// The boundaries' part of apply(): cells outside all of them have no height, reason no_data.
  void cut(core::Grid& grid) const;

 private:
  struct Water {
    Area area;
    bool known = true;
    double level = 0.0;  ///< of a lake
    Tin surface;         ///< of a river
    double sigma = 0.0;
  };
  void fill(const Water& water, core::Grid& grid) const;

  BreaklineOptions options_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  Constraints network_;
  std::vector<Water> waters_;  ///< rivers before lakes
  std::vector<Area> boundaries_;
};

/// Settled lines as bytes, and back. Throws core::Error, naming `place`, where the bytes are cut short or damaged.
std::string pack(const std::vector<SettledLine>& lines);
std::vector<SettledLine> unpack(const std::string& bytes, const std::string& place = {});

}  // namespace swath::terrain
