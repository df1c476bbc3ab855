// SPDX-License-Identifier: GPL-3.0-or-later
// Pulses of a line lie evenly along it, f / v to a metre, and across it as the scan pattern has it over the scan angle. A cell takes those
// between the angles of its two sides; the sides' heights follow the ground's slope at its middle.
#include "planning/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace swath::planning {
namespace {

using Eigen::Vector2d;

constexpr float unknown = std::numeric_limits<float>::quiet_NaN();

/// A cell seen from a line.
struct View {
  double angle = 0.0, height = 0.0;              ///< rad to starboard; m of the line above the ground
  double slope_along = 0.0, slope_across = 0.0;  ///< rise / run, across: to starboard
  double share_along = 0.0;                      ///< of the cell beside the line, between its ends
  double share_across = 0.0;                     ///< of the cell within the field of view
  double pulses = 0.0;                           ///< share of the pulses that meet it
};

class Looker {
 public:
  Looker(const FlightLine& line, const core::HeightField& ground, const Beam& beam, double cell)
      : line_(line),
        ground_(ground),
        beam_(beam),
        cell_(cell),
        along_(line.along()),
        across_(line.across()),
        length_(line.length()),
        reach_((line.level - ground.lowest()) * std::tan(beam.half_angle) + cell) {}

  /// Nothing seen: pulses is 0.
  View at(const Vector2d& p) const {
    View v;
    const Vector2d d = p - line_.from;
    const double s = along_.dot(d), y = across_.dot(d), half = 0.5 * cell_;
    v.share_along = std::clamp(std::min(s + half, length_) - std::max(s - half, 0.0), 0.0, cell_) / cell_;
    if (v.share_along == 0.0 || std::abs(y) > reach_) return v;
    const core::HeightField::Sample ground = ground_.at(p.x(), p.y());
    v.height = line_.level - ground.height;
    if (!(v.height > 0.0)) return v;
    v.slope_along = ground.gradient.dot(along_);
    v.slope_across = ground.gradient.dot(across_);
    v.angle = std::atan2(y, v.height);
    // A cell whose slope falls away from the line more steeply than the beam is not seen.
    if (v.height + y * v.slope_across <= 0.0) return v;
    const auto side = [&](double by) { return std::atan2(y + by, std::max(1e-3, v.height - by * v.slope_across)); };
    const double low = side(-half), high = side(half);
    const double from = std::max(low, -beam_.half_angle), to = std::min(high, beam_.half_angle);
    if (!(to > from)) return v;
    if (beam_.max_range > 0.0 && v.height / std::cos(v.angle) > beam_.max_range) return v;
    if (is_hidden(p, y, v.angle)) return v;
    v.share_across = (to - from) / (high - low);
    v.pulses = pulse_share(beam_.pattern, beam_.half_angle, from, to);
    return v;
  }

 private:
  /// Does ground nearer to the line stand in the beam?
  bool is_hidden(const Vector2d& p, double y, double angle) const {
    const double tangent = std::tan(std::abs(angle)), side = y < 0 ? -1.0 : 1.0;
    for (double back = cell_; back < std::abs(y); back += cell_) {
      const Vector2d q = p - side * back * across_;
      if ((line_.level - ground_.height(q.x(), q.y())) * tangent < std::abs(y) - back) return true;
    }
    return false;
  }

  const FlightLine& line_;
  const core::HeightField& ground_;
  const Beam& beam_;
  double cell_;
  Vector2d along_, across_;
  double length_, reach_;  // reach: no beam meets the ground farther from the line
};

}  // namespace

Coverage coverage_of(const std::vector<FlightLine>& lines, const std::vector<Ring>& area, const core::HeightField& ground, const Beam& beam,
                     const core::SensorSigma& sensor, const TrajectorySigma& trajectory, double cell) {
  Vector2d low = area.front().front(), high = low;
  for (const Ring& r : area)
    for (const Vector2d& p : r) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
  Coverage out;
  out.lattice = core::lattice_of(cell, low.x(), low.y(), high.x(), high.y());
  for (auto* column : {&out.density, &out.lines, &out.sigma_height, &out.sigma_horizontal}) column->assign(out.lattice.size(), unknown);
  std::vector<Looker> lookers;
  for (const FlightLine& line : lines)
    if (line.scans) lookers.emplace_back(line, ground, beam, cell);
  const auto nx = static_cast<size_t>(out.lattice.nx);
  core::in_parallel(out.lattice.size(), 4096, [&](size_t first, size_t last) {
    for (size_t at = first; at < last; ++at) {
      const int i = static_cast<int>(at % nx), j = static_cast<int>(at / nx);
      const Vector2d p(out.lattice.centre_x(i), out.lattice.centre_y(j));
      if (!inside(area, p)) continue;
      double density = 0.0, seen = 0.0, height = 0.0, horizontal = 0.0;
      for (const Looker& looker : lookers) {
        const View v = looker.at(p);
        if (v.pulses == 0.0) continue;
        const double d = beam.prf / beam.speed * v.pulses / cell * v.share_along;
        const ErrorBudget b = error_budget(sources_of(sensor, trajectory, v.height, v.angle, beam.speed), v.height, v.angle);
        density += d;
        seen += v.share_along * v.share_across;
        height += d * std::pow(surface_sigma(b, v.slope_along, -v.slope_across), 2);  // the budget's Y is to port
        horizontal += d * b.total().head<2>().squaredNorm();
      }
      out.density[at] = static_cast<float>(density);
      out.lines[at] = static_cast<float>(seen);
      if (density > 0.0) {
        out.sigma_height[at] = static_cast<float>(std::sqrt(height / density));
        out.sigma_horizontal[at] = static_cast<float>(std::sqrt(horizontal / density));
      }
    }
  });
  return out;
}

}  // namespace swath::planning
