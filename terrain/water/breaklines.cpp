// SPDX-License-Identifier: GPL-3.0-or-later
// Every quantity is made from whole features, never from what a tile sees of them; a tile only chooses which of it it needs. Hence tiles
// agree. Ground points near lines give way as the class "ignored ground" of Heidemann 2018 (USGS TM 11-B4).
#include "terrain/water/breaklines.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <unordered_map>

#include "core/error.h"
#include "terrain/tin/tin_surface.h"
#include "terrain/water/river.h"

namespace swath::terrain {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Edges by cells, to ask whether one is near a place.
class EdgeIndex {
 public:
  EdgeIndex(const Constraints& lines, double reach, double spacing) : lines_(lines), reach_(reach), side_(std::max(reach, spacing)) {
    for (std::uint32_t e = 0; e < lines.edges.size(); ++e) {
      const auto [a, b] = ends(e);
      for (std::int64_t j = cell(std::min(a.y(), b.y()) - reach); j <= cell(std::max(a.y(), b.y()) + reach); ++j)
        for (std::int64_t i = cell(std::min(a.x(), b.x()) - reach); i <= cell(std::max(a.x(), b.x()) + reach); ++i)
          cells_[key(i, j)].push_back(e);
    }
  }
  bool any_near(double x, double y) const {
    const auto at = cells_.find(key(cell(x), cell(y)));
    if (at == cells_.end()) return false;
    const Vector2d p(x, y);
    return std::any_of(at->second.begin(), at->second.end(), [&](std::uint32_t e) {
      const auto [a, b] = ends(e);
      const Vector2d d = b - a;
      const double length = d.squaredNorm(), t = length > 0 ? std::clamp((p - a).dot(d) / length, 0.0, 1.0) : 0.0;
      return (p - a - t * d).squaredNorm() < reach_ * reach_;
    });
  }

 private:
  std::pair<Vector2d, Vector2d> ends(std::uint32_t e) const {
    const auto a = static_cast<size_t>(lines_.edges[e].first), b = static_cast<size_t>(lines_.edges[e].second);
    return {{lines_.x[a], lines_.y[a]}, {lines_.x[b], lines_.y[b]}};
  }
  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v / side_)); }
  static std::int64_t key(std::int64_t i, std::int64_t j) { return i * 0x100000000LL + (j & 0xffffffffLL); }
  const Constraints& lines_;
  double reach_, side_;
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> cells_;
};

template <class T>
void put(std::string& out, const T& v) {
  out.append(reinterpret_cast<const char*>(&v), sizeof v);
}

/// Takes what put() put.
class Unpacker {
 public:
  Unpacker(const std::string& bytes, const std::string& place) : bytes_(bytes), place_(place) {}
  template <class T>
  T take() {
    T v;
    std::memcpy(&v, bytes_.data() + advance(sizeof v), sizeof v);
    return v;
  }
  /// A number of things that take at least `least` bytes each.
  size_t count(size_t least) {
    const auto n = take<std::uint64_t>();
    if (n > (bytes_.size() - at_) / least) damaged();
    return n;
  }
  std::string text(size_t n) { return bytes_.substr(advance(n), n); }

 private:
  size_t advance(size_t n) {
    if (bytes_.size() - at_ < n) damaged();
    at_ += n;
    return at_ - n;
  }
  [[noreturn]] void damaged() const {
    throw core::Error("the settled breaklines are cut short or damaged", place_,
                      "remove the .swath folder beside the products and run again");
  }
  const std::string& bytes_;
  const std::string& place_;
  size_t at_ = 0;
};

}  // namespace

Breaklines::Breaklines(const std::vector<SettledLine>& lines, const BreaklineOptions& options, const Vector3d& origin)
    : options_(options), origin_(origin) {
  std::vector<NetworkLine> network;
  for (const core::BreaklineKind kind :
       {core::BreaklineKind::breakline, core::BreaklineKind::boundary, core::BreaklineKind::river, core::BreaklineKind::lake})
    for (const auto& [line, derived] : lines) {
      if (line.kind != kind) continue;
      if (kind == core::BreaklineKind::boundary) {
        boundaries_.emplace_back(line.parts);
        continue;
      }
      if (line.is_water()) {
        Water water{Area(line.parts), line.has_height, 0.0, {}, line.sigma};
        if (line.has_height && kind == core::BreaklineKind::lake) water.level = line.parts.front().front().z();
        if (line.has_height && kind == core::BreaklineKind::river)
          water.surface = river_surface(line.parts.front(), banks_of(line.parts.front()));
        waters_.push_back(std::move(water));
      }
      if (!line.has_height) continue;
      for (const auto& part : line.parts) {
        network.push_back({part, line.place, line.sigma, derived});
        if (line.is_area()) network.back().vertices.push_back(part.front());
      }
    }
  network_ = line_network(network, options.network, origin);
}

Constraints Breaklines::near(const core::Lattice& w, double reach) const {
  reach += options_.buffer.value;  // points at the far edge of the reach have lines of their own
  return edges_in(network_, w.west() - origin_.x() - reach, w.south() - origin_.y() - reach, w.east() - origin_.x() + reach,
                  w.north() - origin_.y() + reach);
}

std::vector<std::uint32_t> Breaklines::kept(const core::Block& b, const std::vector<std::uint32_t>& rows, const Constraints& near) const {
  if (!b.origin.isApprox(origin_)) throw core::Error("breaklines and points have different origins", "terrain.dtm");
  const EdgeIndex index(near, options_.buffer.value, options_.network.spacing.value);
  std::vector<std::uint32_t> out;
  for (const std::uint32_t r : rows) {
    if (options_.buffer.value > 0.0 && index.any_near(b.x[r], b.y[r])) continue;
    if (std::any_of(waters_.begin(), waters_.end(), [&](const Water& w) { return w.area.holds(b.x[r], b.y[r]); })) continue;
    out.push_back(r);
  }
  return out;
}

void Breaklines::fill(const Water& water, core::Grid& grid) const {
  const core::Lattice& l = grid.lattice;
  const double x0 = l.west() - origin_.x(), y0 = l.south() - origin_.y();
  if (!water.area.box_meets(x0, y0, l.east() - origin_.x(), l.north() - origin_.y())) return;
  std::vector<std::int32_t> triangle;
  if (water.surface.size() > 0) triangle = triangles_at_centres(water.surface, origin_, l);
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const double x = l.centre_x(i) - origin_.x(), y = l.centre_y(j) - origin_.y();
      if (!water.area.holds(x, y)) continue;
      const size_t at = l.at(i, j);
      double z = water.level;
      if (!triangle.empty() && triangle[at] >= 0) z = height_in(water.surface, triangle[at], x, y);
      if (!triangle.empty() && triangle[at] < 0) {  // a bend where rungs leave the river: the nearest bank
        double least = std::numeric_limits<double>::infinity();
        for (size_t v = 0; v < water.surface.x.size(); ++v) {
          const double d = std::hypot(water.surface.x[v] - x, water.surface.y[v] - y);
          if (d < least) least = d, z = water.surface.z[v];
        }
      }
      grid.height[at] = water.known ? static_cast<float>(origin_.z() + z) : std::numeric_limits<float>::quiet_NaN();
      grid.reason[at] = water.known ? core::Void::none : core::Void::water;
      if (!grid.sigma.empty()) grid.sigma[at] = water.known ? static_cast<float>(water.sigma) : std::numeric_limits<float>::quiet_NaN();
    }
}

void Breaklines::apply(core::Grid& grid) const {
  for (const Water& w : waters_) fill(w, grid);
  cut(grid);
}

bool Breaklines::is_water(double x, double y) const {
  return std::any_of(waters_.begin(), waters_.end(), [&](const Water& w) { return w.area.holds(x - origin_.x(), y - origin_.y()); });
}

bool Breaklines::any_water(double x0, double y0, double x1, double y1) const {
  return std::any_of(waters_.begin(), waters_.end(), [&](const Water& w) {
    return w.area.box_meets(x0 - origin_.x(), y0 - origin_.y(), x1 - origin_.x(), y1 - origin_.y());
  });
}

void Breaklines::cut(core::Grid& grid) const {
  if (boundaries_.empty()) return;
  const core::Lattice& l = grid.lattice;
  for (int j = 0; j < l.ny; ++j)
    for (int i = 0; i < l.nx; ++i) {
      const double x = l.centre_x(i) - origin_.x(), y = l.centre_y(j) - origin_.y();
      if (std::any_of(boundaries_.begin(), boundaries_.end(), [&](const Area& a) { return a.holds(x, y); })) continue;
      const size_t at = l.at(i, j);
      grid.height[at] = std::numeric_limits<float>::quiet_NaN();
      grid.reason[at] = core::Void::no_data;
      if (!grid.sigma.empty()) grid.sigma[at] = std::numeric_limits<float>::quiet_NaN();
    }
}

std::string pack(const std::vector<SettledLine>& lines) {
  std::string out;
  put(out, static_cast<std::uint64_t>(lines.size()));
  for (const auto& [line, derived] : lines) {
    put(out, line.kind);
    put(out, line.has_height);
    put(out, derived);
    put(out, line.sigma);
    put(out, static_cast<std::uint64_t>(line.place.size()));
    out += line.place;
    put(out, static_cast<std::uint64_t>(line.parts.size()));
    for (const auto& part : line.parts) {
      put(out, static_cast<std::uint64_t>(part.size()));
      for (const Vector3d& v : part)
        for (int k = 0; k < 3; ++k) put(out, v[k]);
    }
  }
  return out;
}

std::vector<SettledLine> unpack(const std::string& bytes, const std::string& place) {
  Unpacker in(bytes, place);
  constexpr size_t least_line = 3 + sizeof(double) + 2 * sizeof(std::uint64_t);
  std::vector<SettledLine> out(in.count(least_line));
  for (auto& [line, derived] : out) {
    line.kind = in.take<core::BreaklineKind>();
    line.has_height = in.take<bool>();
    derived = in.take<bool>();
    line.sigma = in.take<double>();
    line.place = in.text(in.count(1));
    line.parts.resize(in.count(sizeof(std::uint64_t)));
    for (auto& part : line.parts) {
      part.resize(in.count(3 * sizeof(double)));
      for (Vector3d& v : part)
        for (int k = 0; k < 3; ++k) v[k] = in.take<double>();
    }
  }
  return out;
}

}  // namespace swath::terrain
