// SPDX-License-Identifier: GPL-3.0-or-later
#include "quality/surface_difference.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace swath::quality {
namespace {

constexpr double surface_bin = 1e-3;  // m
constexpr double cover_share = 0.3;   // of the returns of a cell
constexpr int half_histogram = 20;    // bins on each side of zero
constexpr int slope_classes = static_cast<int>(slope_borders.size()) + 1;

struct ReturnKinds {
  std::uint32_t ground = 0, plants = 0, roofs = 0, all = 0;
};

/// Differences of the classes that a row of the table takes together.
struct Together {
  ErrorSums sums;
  Bins bins;
};

Together together(const std::vector<DifferenceSums>& sums, const std::vector<DifferenceBin>& bins, std::optional<int> slope,
                  std::optional<int> cover) {
  Together out;
  const auto is_in = [&](const auto& r) { return (!slope || r.slope == *slope) && (!cover || r.cover == *cover); };
  for (const DifferenceSums& s : sums)
    if (is_in(s)) out.sums.add(s.sums);
  for (const DifferenceBin& b : bins)
    if (is_in(b)) out.bins[b.bin] += b.cells;
  return out;
}

}  // namespace

std::vector<GroundCover> covers_of(const core::Block& b, const core::Lattice& w) {
  namespace kind = core::point_class;
  std::vector<ReturnKinds> cells(w.size());
  for (size_t p = 0; p < b.size(); ++p) {
    if (!core::is_usable(b, p)) continue;
    const std::int64_t i = core::cell_index(b.origin.x() + b.x[p], w.cell) - w.i0,
                       j = core::cell_index(b.origin.y() + b.y[p], w.cell) - w.j0;
    if (i < 0 || j < 0 || i >= w.nx || j >= w.ny) continue;
    ReturnKinds& c = cells[w.at(static_cast<int>(i), static_cast<int>(j))];
    const std::uint8_t type = b.classification[p];
    ++c.all;
    c.ground += type == kind::ground;
    c.roofs += type == kind::building;
    c.plants += type <= kind::unassigned || (type >= kind::low_vegetation && type <= kind::high_vegetation);
  }
  std::vector<GroundCover> out;
  for (const ReturnKinds& c : cells) {
    const double least = cover_share * c.all;
    out.push_back(c.all > 0 && c.roofs >= least       ? GroundCover::building
                  : c.ground == 0                     ? GroundCover::unseen
                  : c.plants > 0 && c.plants >= least ? GroundCover::vegetation
                                                      : GroundCover::open);
  }
  return out;
}

std::string slope_name(int k) {
  const auto text = [](double v) { return std::to_string(static_cast<int>(v)); };
  if (k == 0) return "0 to " + text(slope_borders[0]);
  if (k == slope_classes - 1) return "over " + text(slope_borders.back());
  return text(slope_borders[static_cast<size_t>(k) - 1]) + " to " + text(slope_borders[static_cast<size_t>(k)]);
}

int slope_class_of(double degrees) {
  return static_cast<int>(std::lower_bound(slope_borders.begin(), slope_borders.end(), degrees) - slope_borders.begin());
}

SurfaceDifference compare_surface(const core::Grid& model, const core::Grid& slope, const std::vector<GroundCover>& covers,
                                  const std::function<double(double, double)>& reference) {
  SurfaceDifference out{core::Grid(model.lattice)};
  std::map<std::pair<int, int>, ErrorSums> sums;
  std::map<std::array<std::int32_t, 3>, std::uint32_t> bins;
  for (int j = 0; j < model.lattice.ny; ++j)
    for (int i = 0; i < model.lattice.nx; ++i) {
      const size_t c = model.lattice.at(i, j);
      if (model.reason[c] != core::Void::none) continue;
      const double d = static_cast<double>(model.height[c]) - reference(model.lattice.centre_x(i), model.lattice.centre_y(j));
      if (!std::isfinite(d)) {
        ++out.not_compared;
        continue;
      }
      out.difference.height[c] = static_cast<float>(d);
      out.difference.reason[c] = core::Void::none;
      const int steep = slope_class_of(static_cast<double>(slope.height[c])), cover = static_cast<int>(covers[c]);
      sums[{steep, cover}].add(d);
      ++bins[{steep, cover, bin_of(d, surface_bin)}];
    }
  for (const auto& [key, s] : sums) out.sums.push_back({key.first, key.second, s});
  for (const auto& [key, cells] : bins) out.bins.push_back({key[0], key[1], key[2], cells});
  return out;
}

SurfaceComparison judge_surface(const std::vector<DifferenceSums>& sums, const std::vector<DifferenceBin>& bins) {
  SurfaceComparison out;
  const auto add = [&](const std::string& slope, const std::string& cover, std::optional<int> s, std::optional<int> c) {
    const Together t = together(sums, bins, s, c);
    if (t.sums.n > 0) out.classes.push_back({slope, cover, statistics_of(t.sums, t.bins, surface_bin)});
  };
  add("all", "all", {}, {});
  for (int c = 0; c < static_cast<int>(cover_names.size()); ++c) add("all", std::string(cover_names[static_cast<size_t>(c)]), {}, c);
  for (int s = 0; s < slope_classes; ++s) add(slope_name(s), "all", s, {});
  for (int s = 0; s < slope_classes; ++s) add(slope_name(s), "open", s, static_cast<int>(GroundCover::open));
  if (out.classes.empty()) return out;
  const double width = std::max(surface_bin, 3.0 * out.classes[0].errors.q95 / half_histogram);
  std::map<int, double> wide;
  for (const DifferenceBin& b : bins) wide[std::clamp(bin_of(b.bin * surface_bin, width), -half_histogram, half_histogram)] += b.cells;
  for (const auto& [bin, cells] : wide) {
    out.bins.push_back(bin * width);
    out.bin_cells.push_back(cells);
  }
  return out;
}

}  // namespace swath::quality
