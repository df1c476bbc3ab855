// SPDX-License-Identifier: GPL-3.0-or-later
// Khosravipour et al. 2016, "Generating spike-free digital surface models using LiDAR raw point clouds: A new approach for forestry
// applications". Deviations: the TIN is a plain Delaunay triangulation throughout, so a later point nearby may turn the edges of a closed
// triangle; and it is built in patches, so that within some metres of a patch's border a point is judged by the triangles of that patch.
#include "terrain/tin/spike_free.h"

#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <map>
#include <tuple>

namespace swath::terrain {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Growing =
    CGAL::Delaunay_triangulation_2<Kernel,
                                   CGAL::Triangulation_data_structure_2<CGAL::Triangulation_vertex_base_with_info_2<double, Kernel>>>;

constexpr double patches = 20.0;  // side of a patch in freeze distances
constexpr double border = 8.0;    // around it, in freeze distances

bool is_closed(const Growing::Face_handle& f, double z, const SpikeFreeOptions& o) {
  const double longest = o.freeze.value * o.freeze.value;
  for (int k = 0; k < 3; ++k) {
    if (CGAL::squared_distance(f->vertex(k)->point(), f->vertex((k + 1) % 3)->point()) >= longest) return false;
    if (f->vertex(k)->info() - o.buffer.value <= z) return false;
  }
  return true;
}

/// The rows of one patch and its border that enter, highest first.
std::vector<std::uint32_t> enter(const core::Block& b, std::vector<std::uint32_t> rows, const SpikeFreeOptions& o) {
  std::sort(rows.begin(), rows.end(), [&](std::uint32_t p, std::uint32_t q) {
    return std::make_tuple(-b.z[p], b.x[p], b.y[p]) < std::make_tuple(-b.z[q], b.x[q], b.y[q]);
  });
  std::vector<std::uint32_t> out;
  Growing dt;
  // A face near a place: that of the last vertex in its cell.
  std::map<std::pair<std::int64_t, std::int64_t>, Growing::Vertex_handle> near;
  for (const std::uint32_t r : rows) {
    const Kernel::Point_2 p(b.x[r], b.y[r]);
    const std::pair cell{core::cell_index(b.x[r], o.freeze.value), core::cell_index(b.y[r], o.freeze.value)};
    const auto hint = near.find(cell);
    Growing::Locate_type where = Growing::FACE;
    int which = 0;
    Growing::Face_handle face;
    if (dt.dimension() == 2) {
      face = dt.locate(p, where, which, hint == near.end() ? Growing::Face_handle() : hint->second->face());
      if (where == Growing::VERTEX) continue;
      if (where == Growing::FACE && is_closed(face, b.z[r], o)) continue;
      if (where == Growing::EDGE && !dt.is_infinite(face) && !dt.is_infinite(face->neighbor(which)) && is_closed(face, b.z[r], o) &&
          is_closed(face->neighbor(which), b.z[r], o))
        continue;
    }
    const Growing::Vertex_handle v = dt.dimension() == 2 ? dt.insert(p, where, face, which) : dt.insert(p);
    v->info() = b.z[r];
    near[cell] = v;
    out.push_back(r);
  }
  return out;
}

}  // namespace

double spike_free_halo(const SpikeFreeOptions& o) { return (patches + border) * o.freeze.value; }

std::vector<std::uint32_t> spike_free_rows(const core::Block& b, const std::vector<std::uint32_t>& rows, const core::Lattice& window,
                                           double reach, const SpikeFreeOptions& o) {
  const double side = patches * o.freeze.value, around = border * o.freeze.value;
  const core::Lattice patch =
      core::lattice_of(side, window.west() - reach, window.south() - reach, window.east() + reach, window.north() + reach);
  std::vector<std::vector<std::uint32_t>> of_patch(patch.size());
  for (const std::uint32_t r : rows) {
    const double x = b.x[r] + b.origin.x(), y = b.y[r] + b.origin.y();
    for (std::int64_t j = core::cell_index(y - around, side) - patch.j0; j <= core::cell_index(y + around, side) - patch.j0; ++j)
      for (std::int64_t i = core::cell_index(x - around, side) - patch.i0; i <= core::cell_index(x + around, side) - patch.i0; ++i)
        if (i >= 0 && j >= 0 && i < patch.nx && j < patch.ny) of_patch[patch.at(static_cast<int>(i), static_cast<int>(j))].push_back(r);
  }
  std::vector<std::uint32_t> out;
  for (int j = 0; j < patch.ny; ++j)
    for (int i = 0; i < patch.nx; ++i)
      for (const std::uint32_t r : enter(b, std::move(of_patch[patch.at(i, j)]), o))
        if (core::cell_index(b.x[r] + b.origin.x(), side) == patch.i0 + i && core::cell_index(b.y[r] + b.origin.y(), side) == patch.j0 + j)
          out.push_back(r);
  return out;
}

}  // namespace swath::terrain
