// SPDX-License-Identifier: GPL-3.0-or-later
// Layout: strips along x, flown to and fro; images a base apart; rows of points at multiples of half the distance of strips, columns below
// the images; cross strips one strip's distance beyond the block on both sides. Terrain is level (relief of 150 m makes 1 %).
#include "calib/block/block_theory.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>

#include "calib/block/block_diagnosis.h"
#include "calib/block/block_inference.h"
#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Vector3d;

struct Layout {
  double base, distance, height;
};

Layout layout_of(const TheoryOptions& o) {
  const double side = o.format.value * o.scale;
  return {side * (1.0 - o.forward), side * (1.0 - o.side), o.focal_length.value * o.scale};
}

/// Image x along the direction of flight.
void add_image(ImageBlock& b, double x, double y, double height, double kappa, int strip, double time) {
  BlockImage i;
  i.name = std::to_string(b.images.size() + 1);
  i.position = Vector3d(x, y, height);
  i.camera_R_local << std::cos(kappa), std::sin(kappa), 0.0, -std::sin(kappa), std::cos(kappa), 0.0, 0.0, 0.0, 1.0;
  i.strip = strip;
  i.time = time;
  b.images.push_back(i);
}

void add_images(ImageBlock& b, const TheoryOptions& o, const TheoryCase& c) {
  const Layout l = layout_of(o);
  const double step = l.base / o.speed.value;
  double t = 0.0;
  for (int s = 0; s < o.strips; ++s, t += o.turn.value)
    for (int i = 0; i < o.images; ++i, t += step) {
      const bool back = s % 2 == 1;
      add_image(b, l.base * (back ? o.images - 1 - i : i), l.distance * s, l.height, back ? core::pi : 0.0, s + 1, t);
    }
  const int count = static_cast<int>(std::ceil((o.strips + 1) * l.distance / l.base - 1e-9)) + 1;
  const double begin = ((o.strips - 1) * l.distance - (count - 1) * l.base) / 2.0;
  for (int s = 0; s < c.cross_strips; ++s, t += o.turn.value) {
    const double share = c.cross_strips == 1 ? 0.5 : static_cast<double>(s) / (c.cross_strips - 1);
    const double x = l.base * (1.0 + std::round(share * (o.images - 3)));
    for (int i = 0; i < count; ++i, t += step) {
      const bool back = s % 2 == 1;
      add_image(b, x, begin + l.base * (back ? count - 1 - i : i), l.height, back ? -core::pi / 2.0 : core::pi / 2.0, o.strips + s + 1, t);
    }
  }
}

void add_points(ImageBlock& b, const TheoryOptions& o) {
  const Layout l = layout_of(o);
  for (int row = 0; row <= 2 * o.strips; ++row)
    for (int i = 0; i < o.images; ++i)
      b.points.push_back({std::to_string(b.points.size()), {l.base * i, l.distance * (row - 1) / 2.0, 0.0}});
  const double f = 1e3 * o.focal_length.value, edge = 1e3 * o.usable.value / 2.0 + 1e-9;
  for (std::uint32_t i = 0; i < b.images.size(); ++i)
    for (std::uint32_t p = 0; p < b.points.size(); ++p) {
      const Vector3d d = b.images[i].camera_R_local * (b.points[p].position - b.images[i].position);
      const double x = -f * d.x() / d.z(), y = -f * d.y() / d.z();
      if (std::abs(x) <= edge && std::abs(y) <= edge) b.rays.push_back({i, p, x, y, 1e3 * o.sigma_image.value});
    }
}

void add_control(ImageBlock& b, const TheoryOptions& o, const TheoryCase& c) {
  if (c.control == ControlLayout::none) return;
  const double sigma = o.sigma_control ? o.sigma_control->value : o.unit();
  for (int row = 0; row <= 2 * o.strips; row += 2)
    for (const int column : {0, o.images - 1}) {
      const bool corner = row == 0 || row == 2 * o.strips;
      if (!corner && c.control != ControlLayout::chains) continue;
      const auto p = static_cast<std::uint32_t>(row * o.images + column);
      b.control.push_back({p, false, {corner, corner, true}, b.points[p].position, Vector3d::Constant(sigma)});
    }
}

std::vector<TheoryCase> usual_cases() {
  return {{"1 no drift, chains", DriftSets::none, ControlLayout::chains, 0},
          {"2 block drift, chains", DriftSets::block, ControlLayout::chains, 0},
          {"3 strip drift, chains", DriftSets::strip, ControlLayout::chains, 0},
          {"4 strip drift, cross strips", DriftSets::strip, ControlLayout::corners, 2}};
}

std::vector<TheoryDemand> usual_demands() {
  using core::Metres;
  return {{"1:100 000", 100000.0, Metres(5.0), Metres(4.0)},
          {"1:50 000", 65000.0, Metres(2.5), Metres(2.0)},
          {"1:25 000", 40000.0, Metres(1.5), Metres(1.0)},
          {"1:10 000", 25000.0, Metres(0.8), Metres(0.6)}};
}

/// Accuracy of a case against the sigma of stations, m, both rising; what was computed is kept.
class AccuracyByStation {
 public:
  AccuracyByStation(const TheoryOptions& o, const TheoryCase& c) : options_(o), case_(c) {}

  /// Station sigma, m, at which `mu` of the accuracy is `demand`, to one part in 10 000.
  std::optional<double> reached(double TheoryFound::*mu, double demand, bool& unreachable) {
    constexpr double exact = 1e-4, perfect = 0.05, useless = 150.0;  // of the unit: nothing changes beyond
    constexpr int max_steps = 60;
    double low = perfect * options_.unit(), high = useless * options_.unit();
    unreachable = demand < at(low).*mu;
    if (unreachable || demand >= at(high).*mu) return {};
    for (const auto& [sigma, found] : found_) {
      if (found.*mu <= demand) low = std::max(low, sigma);
      if (found.*mu > demand) high = std::min(high, sigma);
    }
    const auto square = [](double x) { return x * x; };
    double middle = low;
    for (int step = 0; step < max_steps; ++step) {
      // Variances are nearly linear in one another where the bracket is narrow.
      const double share = (square(demand) - square(at(low).*mu)) / (square(at(high).*mu) - square(at(low).*mu));
      middle = step % 2 == 0 ? std::sqrt(square(low) + share * (square(high) - square(low))) : std::sqrt(low * high);
      const double reached = at(middle).*mu;
      if (std::abs(reached - demand) < exact * demand) break;
      (reached < demand ? low : high) = middle;
    }
    return middle;
  }

 private:
  const TheoryFound& at(double sigma) {
    const auto known = found_.find(sigma);
    if (known != found_.end()) return known->second;
    options_.sigma_station = core::Metres(sigma);
    return found_.emplace(sigma, theory_of(options_, case_)).first->second;
  }

  TheoryOptions options_;
  TheoryCase case_;
  std::map<double, TheoryFound> found_;
};

}  // namespace

ImageBlock theoretical_block(const TheoryOptions& o, const TheoryCase& c) {
  ImageBlock b;
  BlockCamera camera;
  camera.name = "camera";
  camera.value[0] = 1e3 * o.focal_length.value;
  b.cameras.push_back(camera);
  add_images(b, o, c);
  add_points(b, o);
  add_control(b, o, c);
  const double sigma = o.sigma_station ? o.sigma_station->value : o.unit();
  for (std::uint32_t i = 0; i < b.images.size(); ++i)
    b.stations.push_back({i, b.images[i].position, sigma * sigma * Eigen::Matrix3d::Identity()});
  b.drift_sets = c.drift;
  find_drift_sets(b);
  return b;
}

TheoryFound theory_of(const TheoryOptions& o, const TheoryCase& c) {
  ImageBlock block = theoretical_block(o, c);
  TheoryFound out;
  out.name = c.name;
  out.unit = o.unit();
  out.images = block.images.size();
  out.rays = block.rays.size();
  out.station = o.sigma_station ? o.sigma_station->value : o.unit();
  const LinearBlock linear = BlockSystem(block, {}).linearise();
  out.points = static_cast<size_t>(linear.points());
  const BlockInference found = infer(linear);
  if (!found.determined() || !found.unsound_points.empty()) {
    try {
      refuse_undetermined(block, linear, found.unsound_points);
    } catch (const core::Error& e) {
      out.refused = std::string(e.what()) + " (" + e.hint() + ")";
    }
    return out;
  }
  Vector3d sum = Vector3d::Zero();
  for (const Eigen::Matrix3d& C : found.points) {
    const Vector3d v = C.diagonal();
    sum += v / static_cast<double>(out.points);
    out.max_xy = std::max(out.max_xy, std::sqrt((v.x() + v.y()) / 2.0));
    out.max_z = std::max(out.max_z, std::sqrt(v.z()));
  }
  out.mu_x = std::sqrt(sum.x()), out.mu_y = std::sqrt(sum.y()), out.mu_z = std::sqrt(sum.z());
  out.mu_xy = std::sqrt((sum.x() + sum.y()) / 2.0);
  return out;
}

TheoryTable theory_table(TheoryOptions o) {
  if (o.cases.empty()) o.cases = usual_cases();
  if (o.demands.empty()) o.demands = usual_demands();
  TheoryTable out;
  for (const TheoryCase& c : o.cases) {
    out.cases.push_back(theory_of(o, c));
    const bool solved = out.cases.back().refused.empty();
    for (const TheoryDemand& d : o.demands) {
      TheoryOptions flown = o;
      flown.scale = d.scale;
      AccuracyByStation accuracy(flown, c);
      AllowedFound a{d.map, c.name, d.scale, {}, {}};
      a.xy_unreachable = d.mu_xy && !solved, a.z_unreachable = d.mu_z && !solved;
      if (solved && d.mu_xy) a.for_xy = accuracy.reached(&TheoryFound::mu_xy, d.mu_xy->value, a.xy_unreachable);
      if (solved && d.mu_z) a.for_z = accuracy.reached(&TheoryFound::mu_z, d.mu_z->value, a.z_unreachable);
      out.allowed.push_back(a);
    }
  }
  return out;
}

std::string theory_text(const TheoryTable& t) {
  std::string out = "accuracy of the points, root mean square, in units of sigma0 times the scale, and in metres\n";
  char line[240];
  std::snprintf(line, sizeof line, "  %-30s %7s %7s %9s %9s\n", "case", "mu_xy", "mu_z", "mu_xy m", "mu_z m");
  out += line;
  for (const TheoryFound& f : t.cases) {
    if (!f.refused.empty()) {
      out += "  " + f.name + ": refused: " + f.refused + "\n";
      continue;
    }
    std::snprintf(line, sizeof line, "  %-30s %7.3f %7.3f %9.3f %9.3f\n", f.name.c_str(), f.mu_xy / f.unit, f.mu_z / f.unit, f.mu_xy,
                  f.mu_z);
    out += line;
  }
  out += "largest sigma of stations, m, that keeps the tolerance in xy and in z (any: no limit; none: missed whatever the stations)\n";
  const auto shown = [](const std::optional<double>& s, bool unreachable) -> std::string {
    char text[32];
    if (s) std::snprintf(text, sizeof text, "%.3g", *s);
    return s ? text : unreachable ? "none" : "any";
  };
  for (const AllowedFound& a : t.allowed) {
    std::snprintf(line, sizeof line, "  %-12s %-30s %8s %8s\n", a.map.c_str(), a.name.c_str(), shown(a.for_xy, a.xy_unreachable).c_str(),
                  shown(a.for_z, a.z_unreachable).c_str());
    out += line;
  }
  return out;
}

}  // namespace swath::calib
