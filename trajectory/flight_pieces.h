// SPDX-License-Identifier: GPL-3.0-or-later
// A record of fixes cut into straight pieces, turns and stands.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trajectory/fix_window.h"

namespace swath::trajectory {

enum class PieceKind { line, straight, turn, standing };

/// Fixes [first, end) of one kind of motion.
struct FlightPiece {
  PieceKind kind = PieceKind::straight;
  size_t first = 0, end = 0;
  std::int32_t line = 0;  ///< number of the flight line, where lines are stated
  double course = 0.0;    ///< mean, clockwise from north, rad; of straight pieces

  size_t size() const { return end - first; }
  /// "line 3", "straight 12 at 270 deg", "turns", "standing".
  std::string name(int number) const;
};

/// By course: a turn is where the course over five seconds changes faster than `turn_rate` (rad/s); a stand is slower than 0.5 m/s. Pieces
/// end at steps longer than `longest_step`. They cover all fixes.
std::vector<FlightPiece> pieces_by_course(const PointFixes& fixes, double turn_rate, double longest_step);

/// A stated flight line: fixes within [start, end], s.
struct LineSpan {
  std::int32_t line = 0;
  double start = 0.0, end = 0.0;
};
/// By the stated lines; what lies between them are turns. They cover all fixes.
std::vector<FlightPiece> pieces_by_line(const PointFixes& fixes, const std::vector<LineSpan>& lines);

/// First fixes of pieces within which the acceleration may pass for one of a single level: pieces of flight, long ones cut to about a
/// minute, short ones joined.
std::vector<size_t> level_pieces(const PointFixes& fixes, const std::vector<FlightPiece>& pieces);

}  // namespace swath::trajectory
