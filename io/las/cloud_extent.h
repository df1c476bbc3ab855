// SPDX-License-Identifier: GPL-3.0-or-later
// Where the points of a cloud lie: a header's box can be wrong, and single points far away.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <utility>

namespace swath::io {

/// Places are counted in cells, about 1 km wide. The middle half of the points in each direction gives a box, which is grown by three times
/// its longer side, and at least by 30 cells. Every place in it counts as one of the cloud. Outside it a group of adjoining cells does
/// where it has 100 points or more that are not all at one place. Where more than a quarter of the points would lie outside, none is known
/// to be a wrong one, and all are of the cloud. The answer does not depend on the order of the points.
class CloudExtent {
 public:
  /// `cell`: units of the coordinates.
  explicit CloudExtent(double cell) : cell_(cell) {}

  /// Of `points` points that all lie in a box, as its file states.
  static CloudExtent of_box(double cell, const Eigen::Vector2d& low, const Eigen::Vector2d& high, std::uint64_t points);

  void add(double x, double y);
  /// Must be called once, behind the last add().
  void settle();

  bool holds(double x, double y) const;
  std::uint64_t points() const { return points_; }  ///< held
  bool is_stated() const { return is_stated_; }     ///< is it a box that was stated, whose points nobody has looked at?
  /// Corners of the box around the points that are held; not finite where there are none.
  const Eigen::Vector2d& low() const { return low_; }
  const Eigen::Vector2d& high() const { return high_; }

 private:
  using Key = std::pair<std::int64_t, std::int64_t>;
  struct Cell {
    std::uint64_t points = 0;
    double x0 = std::numeric_limits<double>::infinity(), y0 = x0, x1 = -x0, y1 = -x0;
    void add(const Cell& o);
  };
  Key key(double x, double y) const;
  void coarsen();
  void find_box();
  void judge_groups();
  bool in_box(const Key& k) const { return k.first >= i0_ && k.first <= i1_ && k.second >= j0_ && k.second <= j1_; }

  double cell_;
  std::map<Key, Cell> cells_;  ///< settled: only those that are held
  std::pair<const Key, Cell>* last_ = nullptr;
  std::int64_t i0_ = 0, i1_ = 0, j0_ = 0, j1_ = 0;
  std::uint64_t points_ = 0;
  bool is_stated_ = false;
  Eigen::Vector2d low_ = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity()), high_ = -low_;
};

struct FileExtent {
  CloudExtent places;
  bool has_few_wild_heights = true;  ///< does a quarter of the points at most lie beyond the heights asked for?
};

/// Of a LAS or LAZ file, in its own coordinates and heights. A header's box of at most 30 cells a side and within the heights, in which the
/// first points of the file lie, is taken as it is: no point in it could be far from the others. Otherwise all points are looked at, by so
/// many threads.
FileExtent extent_of_cloud(const std::filesystem::path& file, double cell, double lowest, double highest, unsigned threads);

}  // namespace swath::io
