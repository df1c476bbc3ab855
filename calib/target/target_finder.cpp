// SPDX-License-Identifier: GPL-3.0-or-later
// Heights are taken cell by cell of one line at a time: lines are still displaced against one another by metres. Neighbouring cells whose
// returns agree in height make a patch; a patch is a roof where it is level, fills a rectangle, and what lies around it is lower.
#include "calib/target/target_finder.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <unordered_set>

#include "core/config/units.h"

namespace swath::calib {

using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr float flat_cell = 0.6f;     // m between lowest and highest return of a cell on the roof
constexpr float step = 0.3f;          // m between neighbouring cells of one patch
constexpr double roughest = 0.15;     // m, rms of the cells about the patch's plane
constexpr double fills = 0.8;         // of the rectangle
constexpr double surrounded = 0.85;   // of the cells around that hold returns are lower
constexpr double per_cell = 3.0;      // returns: one cell in twenty is empty then, and patches are connected
constexpr double coarse_cell = 10.0;  // m, in which returns are counted for their density
constexpr double known_around = 0.6;  // of the cells around hold returns: a roof at the swath's edge is not known to end there

using Key = std::pair<std::int32_t, std::int32_t>;
using Cells = std::unordered_set<std::uint64_t>;

std::uint64_t packed(Key k) {
  return static_cast<std::uint64_t>(static_cast<std::uint32_t>(k.first)) << 32 | static_cast<std::uint32_t>(k.second);
}
Key unpacked(std::uint64_t p) { return {static_cast<std::int32_t>(p >> 32), static_cast<std::int32_t>(p & 0xffffffffu)}; }

/// Along an azimuth and to its right.
Vector2d turned(const Vector2d& v, double azimuth) {
  return {v.x() * std::sin(azimuth) + v.y() * std::cos(azimuth), v.x() * std::cos(azimuth) - v.y() * std::sin(azimuth)};
}

/// The smallest rectangle around cells' centres.
void fit_rectangle(const std::vector<Vector2d>& centres, double cell, FoundRoof& roof) {
  double least = 1e300;
  constexpr double fine = 0.5 * core::degree;
  for (int k = 0; k < 180; ++k) {
    const double azimuth = k * fine;
    Vector2d low(1e300, 1e300), high(-1e300, -1e300);
    for (const Vector2d& c : centres) {
      const Vector2d v = turned(c, azimuth);
      low = low.cwiseMin(v);
      high = high.cwiseMax(v);
    }
    const Vector2d side = high - low + Vector2d(cell, cell);
    if (side.prod() >= least) continue;
    least = side.prod();
    const Vector2d middle = 0.5 * (low + high);
    roof.centre = {middle.x() * std::sin(azimuth) + middle.y() * std::cos(azimuth),
                   middle.x() * std::cos(azimuth) - middle.y() * std::sin(azimuth)};
    roof.azimuth = azimuth;
    roof.half = 0.5 * side;
  }
  roof.share = static_cast<double>(centres.size()) * cell * cell / least;
  if (roof.half.x() < roof.half.y()) {
    std::swap(roof.half.x(), roof.half.y());
    roof.azimuth += 0.5 * core::pi;
  }
}

/// Edge of the cells for one line's returns, m: as stated, or wider where the line is sparse, though a third of the roof's side at most.
double cell_for(const std::vector<Eigen::Vector3f>& points, const FinderOptions& options) {
  Cells seen;
  for (const Eigen::Vector3f& p : points)
    seen.insert(
        packed({static_cast<std::int32_t>(std::floor(p.x() / coarse_cell)), static_cast<std::int32_t>(std::floor(p.y() / coarse_cell))}));
  const double area = static_cast<double>(seen.size()) * coarse_cell * coarse_cell;
  const double wanted = std::sqrt(per_cell * area / static_cast<double>(points.size()));
  return std::max(options.cell, std::min(wanted, options.shortest / 3.0));
}

}  // namespace

void HeightGrid::add(const Vector3d& p) {
  const Key key{static_cast<std::int32_t>(std::floor(p.x() / cell_)), static_cast<std::int32_t>(std::floor(p.y() / cell_))};
  const auto up = static_cast<float>(p.z());
  const auto [at, made] = cells_.try_emplace(packed(key), Cell{up, up, 0.0, 0});
  Cell& c = at->second;
  c.lowest = std::min(c.lowest, up);
  c.highest = std::max(c.highest, up);
  c.sum += p.z();
  ++c.n;
}

/// The patch's plane; false where it is not level and smooth.
bool HeightGrid::fit_plane(const std::vector<Key>& patch, const std::vector<Vector2d>& centres, const FinderOptions& options,
                           FoundRoof& roof) const {
  Eigen::Matrix3d N = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  for (size_t i = 0; i < patch.size(); ++i) {
    const Vector3d row(1.0, centres[i].x() - centres.front().x(), centres[i].y() - centres.front().y());
    N += row * row.transpose();
    b += row * static_cast<double>(cells_.at(packed(patch[i])).mean());
  }
  roof.plane = N.ldlt().solve(b);
  roof.plane[0] -= roof.plane.tail<2>().dot(centres.front());
  if (roof.plane.tail<2>().norm() > options.level) return false;
  double squares = 0.0;
  for (size_t i = 0; i < patch.size(); ++i)
    squares += std::pow(static_cast<double>(cells_.at(packed(patch[i])).mean()) - roof.up(centres[i]), 2);
  return std::sqrt(squares / static_cast<double>(patch.size())) <= roughest;
}

/// Two cells away from the patch all is lower.
bool HeightGrid::is_surrounded(const std::vector<Key>& patch, const FinderOptions& options, const FoundRoof& roof) const {
  Cells own, near, around;
  for (const Key& k : patch) own.insert(packed(k));
  for (const Key& k : patch)
    for (std::int32_t i = -2; i <= 2; ++i)
      for (std::int32_t j = -2; j <= 2; ++j) {
        const std::uint64_t other = packed({k.first + i, k.second + j});
        if (own.contains(other)) continue;
        (std::abs(i) < 2 && std::abs(j) < 2 ? near : around).insert(other);
      }
  size_t known = 0, lower = 0, all = 0;
  for (const std::uint64_t other : around) {
    if (near.contains(other)) continue;
    ++all;
    const auto at = cells_.find(other);
    if (at == cells_.end()) continue;
    ++known;
    const Key k = unpacked(other);
    lower +=
        static_cast<double>(at->second.mean()) < roof.up(cell_ * (Vector2d(k.first, k.second) + Vector2d(0.5, 0.5))) - options.stands_out;
  }
  return static_cast<double>(known) >= known_around * static_cast<double>(all) &&
         static_cast<double>(lower) >= surrounded * static_cast<double>(known);
}

std::vector<FoundRoof> HeightGrid::roofs(const FinderOptions& options) const {
  std::vector<Key> keys;
  for (const auto& [key, cell] : cells_)
    if (cell.highest - cell.lowest < flat_cell) keys.push_back(unpacked(key));
  std::sort(keys.begin(), keys.end());
  Cells left;  // a patch of level ground has half a million cells
  for (const Key& k : keys) left.insert(packed(k));
  std::vector<FoundRoof> out;
  const auto fewest = static_cast<size_t>(options.shortest * options.shortest / (cell_ * cell_) / 2);
  for (const Key& start : keys) {
    if (left.erase(packed(start)) == 0) continue;
    std::vector<Key> patch{start};
    for (size_t i = 0; i < patch.size(); ++i) {
      const float here = cells_.at(packed(patch[i])).mean();
      for (const Key& d : {Key{1, 0}, Key{-1, 0}, Key{0, 1}, Key{0, -1}}) {
        const Key next{patch[i].first + d.first, patch[i].second + d.second};
        const auto at = left.find(packed(next));
        if (at == left.end() || std::abs(cells_.at(packed(next)).mean() - here) > step) continue;
        left.erase(at);
        patch.push_back(next);
      }
    }
    if (patch.size() < fewest) continue;

    FoundRoof roof;
    std::vector<Vector2d> centres;
    for (const Key& k : patch) centres.push_back(cell_ * (Vector2d(k.first, k.second) + Vector2d(0.5, 0.5)));
    if (!fit_plane(patch, centres, options, roof) || !is_surrounded(patch, options, roof)) continue;
    fit_rectangle(centres, cell_, roof);
    if (roof.share < fills || 2.0 * roof.half.y() < options.shortest) continue;
    out.push_back(roof);
  }
  return out;
}

namespace {

/// The target: of the largest area times lines that show it.
std::optional<RoofTarget> largest_target(const std::vector<std::pair<FoundRoof, int>>& found,
                                         const std::optional<trajectory::LocalFrame>& frame, double near) {
  std::optional<RoofTarget> best;
  double score = 0.0;
  for (const auto& [seed, seed_line] : found) {
    Vector2d centre(0, 0), half(0, 0), axis(0, 0);
    double up = 0.0;
    std::set<int> lines;
    for (const auto& [r, of] : found) {
      const double size = r.half.prod() / seed.half.prod();
      constexpr double alike = 0.7;
      if ((r.centre - seed.centre).norm() > near || size < alike || size > 1.0 / alike || !lines.insert(of).second) continue;
      centre += r.centre;
      half += r.half;
      axis += Vector2d(std::cos(2.0 * r.azimuth), std::sin(2.0 * r.azimuth));
      up += r.up(r.centre);
    }
    const double n = static_cast<double>(lines.size());
    const double mine = 4.0 * seed.half.prod() * n;
    if (mine <= score) continue;
    score = mine;
    centre /= n;
    half /= n;
    up /= n;
    // A square has no longer side: its azimuths cancel by right angles.
    const double azimuth = axis.norm() > 0.5 * n ? 0.5 * std::atan2(axis.y(), axis.x()) : seed.azimuth;
    const Vector2d x(std::sin(azimuth), std::cos(azimuth)), y(x.y(), -x.x());
    std::vector<Vector3d> corners;
    for (const Vector2d& c : {Vector2d(1, 1), Vector2d(1, -1), Vector2d(-1, -1), Vector2d(-1, 1)}) {
      const Vector2d p = centre + c.x() * half.x() * x + c.y() * half.y() * y;
      corners.push_back(frame->to_ecef({p.x(), p.y(), up}));
    }
    constexpr double as_found = 0.03;  // m, of corners once they are the mean of the lines
    best = roof_target("largest flat roof", corners, as_found, as_found);
    best->surveyed = false;
  }
  return best;
}

}  // namespace

std::optional<RoofTarget> find_roof(const ShotStream& shots, const ShotGeometry& geometry, const trajectory::Trajectory& trajectory,
                                    double search, const FinderOptions& options) {
  std::optional<trajectory::LocalFrame> frame;
  trajectory::Cursor cursor(trajectory);
  std::vector<Eigen::Vector3f> points;           // of one line, in the frame
  std::vector<std::pair<FoundRoof, int>> found;  // with the line
  int line = 0;
  double range = 0.0, widest = options.cell;
  const auto close_line = [&] {
    const double cell = cell_for(points, options);
    widest = std::max(widest, cell);
    HeightGrid grid(cell);
    for (const Eigen::Vector3f& p : points) grid.add(p.cast<double>());
    for (const FoundRoof& r : grid.roofs(options)) found.push_back({r, line});
    points.clear();
  };
  shots([&](int id, const core::Shots& s) {
    if (id != line && !points.empty()) close_line();
    line = id;
    for (size_t i = 0; i < s.size(); ++i) {
      const double t = geometry.time(s.time[i]);
      const double forward = s.forward.empty() ? 0.0 : s.forward[i];
      if (!std::isfinite(s.angle[i]) || !(s.range[i] > 0.0) || !(std::abs(forward) <= 1.0) || !cursor.seek(t)) continue;
      const Vector3d p = geometry.ecef_point(cursor.pose(t), {s.angle[i], forward, s.range[i]});
      if (!frame) frame = trajectory::local_frame(p);
      range = std::max(range, s.range[i]);
      points.emplace_back((frame->local_R_ecef * (p - frame->origin)).cast<float>());
    }
  });
  if (!points.empty()) close_line();

  return largest_target(found, frame, 2.0 * search * range + 2.0 * widest);
}

}  // namespace swath::calib
