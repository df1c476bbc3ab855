// SPDX-License-Identifier: GPL-3.0-or-later
// Breaklines as one network of short edges that meet at vertices only: what a constrained triangulation takes.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "terrain/tin/tin.h"

namespace swath::terrain {

struct NetworkOptions {
  core::Metres spacing{2.0};
  core::Metres tolerance{0.01};
};

template <class V>
void describe(NetworkOptions& o, V& v) {
  v.option("spacing", o.spacing, core::above(0.0), "Longest edge: lines are divided into pieces of at most this length.");
  v.option("tolerance", o.tolerance, core::at_least(0.0),
           "Lines that meet or cross must agree in height within this; otherwise the run ends.");
}

/// A line of the network. Heights that were derived from points yield to surveyed ones where lines meet.
struct NetworkLine {
  std::vector<Eigen::Vector3d> vertices;  ///< m; a ring repeats its first vertex
  std::string place;                      ///< for messages
  double sigma = 0.0;                     ///< m
  bool yields = false;
};

/// Vertices stay where they are (those within 1 mm of one another become one), lines get a vertex where they meet or cross, and pieces
/// longer than `spacing` are divided evenly. The result depends on nothing but the lines; heights between vertices are linear.
/// `origin` is added to places in messages. Throws core::Error naming both lines and the place where two that do not yield meet at
/// heights that differ by more than `tolerance`.
Constraints line_network(const std::vector<NetworkLine>& lines, const NetworkOptions& options,
                         const Eigen::Vector3d& origin = Eigen::Vector3d::Zero());

/// The edges of `all` that come into the box, with their vertices.
Constraints edges_in(const Constraints& all, double x0, double y0, double x1, double y1);

}  // namespace swath::terrain
