// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers decide, the flight's geometry chooses the words. An eigenvector of the information, scaled to the start values' sigmas, whose
// eigenvalue is below 1 is a combination of values of which the start values know more than the flight.
#include "calib/adjust/diagnosis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "calib/adjust/parameter_words.h"
#include "calib/adjust/start_sigmas.h"
#include "calib/words.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double sloping_from = 10.0 * core::degree;
constexpr double beside_from = 12.0 * core::degree;  // difference of the scan angles at which two parallel lines see a plane
constexpr double height_ratio = 1.2;
constexpr double part_of_combination = 0.15;  // share of an eigenvector's square that makes a value a part of it
constexpr double rests_on_position = 3.0;     // limits: a value is determined by the trajectory's positions alone beyond

struct Words {
  std::string what, cure;
};

const char* const opposite_cure = "fly one line in the opposite direction over the same buildings";
const char* const slopes_cure = "fly over buildings with sloping roofs or walls";
const char* const control_cure = "survey the plane of a roof or of level ground in the block";

Words words_for(Parameter p, const FlightShape& s) {
  const std::string name(words_of(p).name);
  if (s.lines == 0)
    return {name + ": no plane is seen by two lines", "fly lines that overlap, with buildings or even ground in the overlap"};
  if (s.lines == 1)
    return {name + " cannot be told from the trajectory's own errors and the lie of the planes: one line only",
            "fly the same ground in the opposite direction and across"};
  const bool one_way = !s.opposite && !s.crossed;
  switch (p) {
    case boresight_roll:
    case scan_offset:
      if (one_way)
        return {name + " and a tilt or shift of the trajectory across the track cannot be separated: only one line direction",
                opposite_cure};
      break;
    case boresight_pitch:
      if (s.sloping == 0) return {name + " shows on sloping planes alone, and all are level: no sloping planes or walls", slopes_cure};
      if (one_way) return {name + " and along-track shift cannot be separated: only one line direction", opposite_cure};
      break;
    case boresight_heading:
      if (s.sloping == 0) return {name + " shows on sloping planes alone, and all are level: no sloping planes or walls", slopes_cure};
      if (!s.beside)
        return {name + " moves points at the swath's edge, and no two parallel lines see common planes at angles well apart",
                "fly parallel lines side by side in opposite directions, the buildings at the swath's edge, and one line across"};
      if (!s.crossed) return {name + " and pitch are hard to tell apart without cross lines", "fly one line across the others"};
      break;
    case range_offset:
      if (!s.control && !s.two_heights)
        return {name + " and a common error of height cannot be separated: neither control nor a second flying height", control_cure};
      if (!s.control) return {name + " and a common error of height cannot be separated: no control", control_cure};
      break;
    case range_scale:
      if (!s.two_heights || !s.control)
        return {name + " looks like a range offset from one height, and like an error of height without control",
                "fly a second height over a surveyed plane"};
      break;
    case scan_scale:
      if (!s.crossed && !s.beside)
        return {name + " bends each swath alike, and no lines cross or lie side by side", "fly one line across the others"};
      if (!s.control)
        return {name + " raises the swath's edges little at narrow angles", "fly cross lines, wide angles and a surveyed plane"};
      break;
    case lever_forward:
    case lever_right:
    case lever_down:
      return {name + " moves with the carrier like a shift of the position, or like an angle from one height",
              "measure it on the ground; or fly opposite lines at two heights with control"};
    case latency:
      return {name + " looks like a shift along the track, and like pitch at one speed and height",
              "fly opposite lines at two heights and speeds, and with turns of the attitude"};
    default:
      break;
  }
  return {name + " is not told to a useful accuracy by these lines and this trajectory",
          "fly more lines over more planes, or with a better trajectory"};
}

std::string in_words(Parameter p, double sigma) {
  return words("%.3g ", sigma / words_of(p).sigma_size) + std::string(words_of(p).sigma_unit);
}

std::string joined(const std::vector<Parameter>& list) {
  std::string out;
  for (size_t i = 0; i < list.size(); ++i) {
    if (i > 0) out += i + 1 < list.size() ? ", " : " and ";
    out += words_of(list[i]).name;
  }
  return out;
}

}  // namespace

double limit_of(const LimitOptions& o, Parameter p) {
  switch (p) {
    case boresight_roll:
    case boresight_pitch:
      return o.roll_pitch.value;
    case boresight_heading:
      return o.heading.value;
    case lever_forward:
    case lever_right:
    case lever_down:
      return o.lever_arm.value;
    case range_offset:
      return o.range_offset.value;
    case range_scale:
      return o.range_scale;
    case scan_offset:
      return o.scan_offset.value;
    case scan_scale:
      return o.scan_scale;
    default:
      return o.latency.value;
  }
}

FlightShape shape_of(const TieProblem& problem, const TieState& state, const std::vector<GroupBlock>& blocks) {
  const TieSet& ties = *problem.ties;
  FlightShape s;
  struct LineShape {
    Vector3d track = Vector3d::Zero();
    double depth = 0.0, groups = 0.0;
  };
  std::vector<LineShape> lines(ties.lines.size());
  for (size_t g = 0; g < blocks.size(); ++g) {
    if (blocks[g].used == 0) continue;
    LineShape& l = lines[ties.groups[g].line];
    l.depth += blocks[g].depth;
    l.groups += 1.0;
    if (const auto pose = problem.trajectory->pose_at(blocks[g].time)) {
      const Vector3d local = ties.frame.local_R_ecef * pose->velocity;
      l.track += Vector3d(local.x(), local.y(), 0.0).normalized();
    }
  }
  for (LineShape& l : lines)
    if (l.groups > 0.0) l.depth /= l.groups, l.track.normalize();
  std::set<std::uint32_t> seen;
  std::map<std::uint32_t, std::vector<size_t>> of_plane;
  for (size_t g = 0; g < blocks.size(); ++g)
    if (blocks[g].used > 0) of_plane[ties.groups[g].plane].push_back(g);
  for (const auto& [plane, groups] : of_plane) {
    std::set<std::uint32_t> here;
    for (const size_t g : groups) here.insert(ties.groups[g].line);
    const TiePlane& p = state.planes[plane];
    if (!p.control.empty()) s.control = true;
    if (here.size() < 2) continue;
    ++s.common;
    if (std::acos(std::clamp(p.normal.z(), -1.0, 1.0)) > sloping_from) ++s.sloping;
    seen.insert(here.begin(), here.end());
    for (const size_t a : groups) {
      s.widest = std::max(s.widest, std::abs(blocks[a].angle));
      for (const size_t b : groups) {
        const LineShape &x = lines[ties.groups[a].line], &y = lines[ties.groups[b].line];
        if (ties.groups[a].line == ties.groups[b].line) continue;
        const double turn = x.track.dot(y.track);
        if (turn < -0.9) s.opposite = true;
        if (std::abs(turn) < 0.7) s.crossed = true;
        // The angle to starboard of one line is that to port of the opposite one.
        if (std::abs(turn) > 0.9 && std::abs(blocks[a].angle - (turn > 0.0 ? 1.0 : -1.0) * blocks[b].angle) > beside_from) s.beside = true;
        if (x.depth > height_ratio * y.depth) s.two_heights = true;
      }
    }
  }
  s.lines = static_cast<int>(seen.size());
  if (s.lines == 0) {
    const auto flown = static_cast<int>(std::count_if(lines.begin(), lines.end(), [](const LineShape& l) { return l.groups > 0.0; }));
    if (s.control || flown == 1) s.lines = flown;
  }
  return s;
}

double scaled_condition(const MatrixXd& information) {
  if (information.rows() == 0) return 1.0;
  const VectorXd scale = information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(scale.asDiagonal() * information * scale.asDiagonal(), Eigen::EigenvaluesOnly);
  const double least = eigen.eigenvalues().minCoeff();
  return least > 1e-15 ? eigen.eigenvalues().maxCoeff() / least : std::numeric_limits<double>::infinity();
}

std::vector<Finding> diagnose(const std::vector<Parameter>& globals, const Separation& sep, const VectorXd& apriori,
                              const FlightShape& shape, const LimitOptions& limits) {
  const auto n = static_cast<Eigen::Index>(globals.size());
  std::vector<Finding> out;
  if (n == 0) return out;
  // A start value that counts for nothing is as uncertain as an uncalibrated mounting's.
  VectorXd known(n);
  for (Eigen::Index i = 0; i < n; ++i) known[i] = std::isfinite(apriori[i]) ? apriori[i] : apriori_of({}, globals[i]);
  std::vector<bool> refused(globals.size()), named(globals.size());
  for (Eigen::Index i = 0; i < n; ++i) refused[i] = !(1.0 - std::pow(sep.formal[i] / known[i], 2) >= limits.determined);

  // Where the flight brings less than the start values, the combination is not its own.
  const double least = limits.determined / std::max(1e-9, 1.0 - limits.determined);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(known.asDiagonal() * sep.information * known.asDiagonal());
  for (Eigen::Index k = 0; k < n && eigen.eigenvalues()[k] < least; ++k) {
    std::vector<Parameter> parts;
    for (Eigen::Index i = 0; i < n; ++i)
      if (std::pow(eigen.eigenvectors()(i, k), 2) > part_of_combination && refused[i]) parts.push_back(globals[i]);
    if (parts.size() < 2) continue;
    if (std::all_of(parts.begin(), parts.end(),
                    [&](Parameter p) { return named[std::find(globals.begin(), globals.end(), p) - globals.begin()]; }))
      continue;
    Finding f{joined(parts) + " cannot be separated", "", parts, true};
    std::set<std::string> cures;
    for (const Parameter p : parts) {
      const Words w = words_for(p, shape);
      f.what += "; " + w.what;
      if (cures.insert(w.cure).second) f.cure += (f.cure.empty() ? "" : "; ") + w.cure;
      named[std::find(globals.begin(), globals.end(), p) - globals.begin()] = true;
    }
    out.push_back(std::move(f));
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const Words w = words_for(globals[i], shape);
    const double limit = limit_of(limits, globals[i]);
    if (refused[i] && !named[i]) {
      out.push_back({w.what, w.cure, {globals[i]}, true});
    } else if (!refused[i] && !(sep.formal[i] <= limit)) {
      out.push_back({std::string(words_of(globals[i]).name) + " is coarse: known to " + in_words(globals[i], sep.formal[i]) +
                         ", where a sigma of " + in_words(globals[i], limit) + " is graded good; " + w.what,
                     w.cure,
                     {globals[i]},
                     false});
    } else if (!refused[i] && sep.unaided.size() == n && sep.unaided[i] > rests_on_position * limit) {
      out.push_back({w.what + "; its value rests on the trajectory's positions alone", w.cure, {globals[i]}, false});
    }
  }
  return out;
}

}  // namespace swath::calib
