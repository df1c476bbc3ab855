// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/objects_file.h"

#include <cmath>
#include <cstdio>
#include <string>

#include "core/block.h"
#include "io/text/output_file.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;

void write_rows_of(const std::filesystem::path& file, const std::string& head, const std::string& rows) {
  if (!rows.empty()) io::write_text_file(file, head + "\n" + rows);
}

double height_at(const Wire& w, double s) { return w.low + w.a * (std::cosh((s - w.middle) / w.a) - 1.0); }

/// Largest height of the chord above the wire: where the wire is as steep as the chord.
double sag_of(const Wire& w) {
  const double slope = (height_at(w, w.length) - height_at(w, 0.0)) / w.length, s = w.middle + w.a * std::asinh(slope);
  return height_at(w, 0.0) + slope * s - height_at(w, s);
}

}  // namespace

void write_objects(const std::filesystem::path& truth, const World& world, const MapPatch& map) {
  const Eigen::Vector3d& origin = map.map_origin();
  std::string wires, pylons, trees;
  char row[300];
  for (const Wire& w : world.wires()) {
    const Vector2d a = w.from + origin.head<2>(), b = a + w.length * w.along;
    std::snprintf(row, sizeof row, "%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.6f,%.6f,%.4f,%.4f\n", a.x(), a.y(), height_at(w, 0.0) + origin.z(),
                  b.x(), b.y(), height_at(w, w.length) + origin.z(), w.a, w.middle, w.low + origin.z(), sag_of(w));
    wires += row;
  }
  for (const Building& b : world.buildings()) {
    if (b.kind == core::point_class::building || b.kind == core::point_class::bridge_deck) continue;
    std::snprintf(row, sizeof row, "%.4f,%.4f,%.4f\n", b.centre.x() + origin.x(), b.centre.y() + origin.y(), b.top + origin.z());
    pylons += row;
  }
  for (const Tree& t : world.trees()) {
    std::snprintf(row, sizeof row, "%.4f,%.4f,%.4f,%.4f,%.4f\n", t.centre.x() + origin.x(), t.centre.y() + origin.y(),
                  t.ground + origin.z(), t.centre.z() + t.half_height - t.ground, t.radius);
    trees += row;
  }
  write_rows_of(truth / "wires.csv", "x0,y0,z0_end,x1,y1,z1_end,a,s0,z0,sag", wires);
  write_rows_of(truth / "pylons.csv", "x,y,top", pylons);
  write_rows_of(truth / "trees.csv", "x,y,ground,height,radius", trees);
}

}  // namespace swath::simulate
