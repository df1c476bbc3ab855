// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/control_files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/block.h"
#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::simulate {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double clear = 3.0;  // m from a ground point to the nearest building or tree

const char* const roof_in_the_middle = "building roof 1";

Vector3d middle_of(const Facet& f) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& c : f.corners) sum += c;
  return sum / static_cast<double>(f.corners.size());
}

/// `n` facets far from one another: each the farthest from those before, the first the farthest from the area's middle.
std::vector<const Facet*> spread(const std::vector<const Facet*>& all, size_t n) {
  std::vector<const Facet*> chosen;
  while (chosen.size() < n) {
    const Facet* best = nullptr;
    double farthest = -1.0;
    for (const Facet* f : all) {
      const Vector2d p = middle_of(*f).head<2>();
      double nearest = chosen.empty() ? p.norm() : std::numeric_limits<double>::infinity();
      for (const Facet* c : chosen) nearest = c == f ? -1.0 : std::min(nearest, (middle_of(*c).head<2>() - p).norm());
      if (nearest > farthest) farthest = nearest, best = f;
    }
    chosen.push_back(best);
  }
  return chosen;
}

class Surveyor {
 public:
  explicit Surveyor(const Options& o)
      : sigma_(o.noise.noise_free ? 0.0 : o.control.sigma.value),
        shift_(o.control.shift[0].value, o.control.shift[1].value, o.control.shift[2].value),
        seed_(o.seed) {}

  /// `index` names the point's own random numbers.
  SurveyedPoint point(const std::string& name, const std::string& target, const Vector3d& truth, std::uint64_t index) const {
    Random random = random_of(seed_, Stream::control, index);
    const double e = random.normal(), n = random.normal(), h = random.normal();
    return {name, target, truth, truth + shift_ + sigma_ * Vector3d(e, n, h)};
  }

 private:
  double sigma_;
  Vector3d shift_;
  std::int64_t seed_;
};

bool is_open(const World& world, const Vector2d& p) {
  const auto near_building = [&](const Building& b) { return (b.centre - p).norm() < b.radius + clear; };
  const auto near_tree = [&](const Tree& t) { return (t.centre.head<2>() - p).norm() < t.radius + clear; };
  return !world.relief().is_water(p.x(), p.y()) && std::none_of(world.buildings().begin(), world.buildings().end(), near_building) &&
         std::none_of(world.trees().begin(), world.trees().end(), near_tree);
}

}  // namespace

std::vector<SurveyedPoint> survey_points(const Options& o, const World& world, const std::vector<Facet>& facets) {
  const Surveyor surveyor(o);
  std::vector<SurveyedPoint> out;
  const auto add_target = [&](const Facet& f) {
    const auto facet = static_cast<std::uint64_t>(&f - facets.data());
    for (size_t i = 0; i < f.corners.size(); ++i)
      out.push_back(surveyor.point(f.name + " corner " + std::to_string(i + 1), f.name, f.corners[i], facet << 8 | i));
  };
  std::vector<const Facet*> others;
  for (const Facet& f : facets) {
    if (f.name == roof_in_the_middle && o.world.scene == Scene::airfield) {
      if (o.control.roof) add_target(f);
    } else if (f.roof) {
      others.push_back(&f);
    }
  }
  const auto wanted = static_cast<size_t>(o.control.targets);
  if (wanted > others.size())
    throw core::usage_error("the scene has " + std::to_string(others.size()) + " roof facets to survey, fewer than asked",
                            "control.targets", "fewer targets, or more buildings");
  for (const Facet* f : spread(others, wanted)) add_target(*f);

  constexpr std::uint64_t of_ground = std::uint64_t{1} << 40;
  Random random = random_of(o.seed, Stream::control, of_ground - 1);
  const double bearing = o.flight.direction.value;
  const Vector2d along(std::sin(bearing), std::cos(bearing)), across(along.y(), -along.x());
  for (int i = 0, attempt = 0; i < o.control.points; ++attempt) {
    if (attempt > 1000 * o.control.points)
      throw core::usage_error("no open ground was found for the surveyed points", "control.points", "fewer points");
    const Vector2d p = random.uniform(-0.5, 0.5) * o.world.length.value * along + random.uniform(-0.5, 0.5) * o.world.width.value * across;
    if (!is_open(world, p)) continue;
    ++i;
    out.push_back(surveyor.point("ground " + std::to_string(i), "", {p.x(), p.y(), world.relief().height(p.x(), p.y())},
                                 of_ground + static_cast<std::uint64_t>(i)));
  }
  return out;
}

std::vector<io::ControlFile> write_control(const std::filesystem::path& folder, const std::vector<SurveyedPoint>& points,
                                           const ControlOptions& options, const MapPatch& map) {
  const auto row = [&](const SurveyedPoint& p, const Vector3d& at, double sigma) {
    char text[160];
    const Vector3d m = at + map.map_origin();
    std::snprintf(text, sizeof text, ",%.6f,%.6f,%.6f,%.6g,%.6g\n", m.x(), m.y(), m.z(), sigma, sigma);
    return p.name + "," + p.target + text;
  };
  const std::string header = "name,target,x,y,z,sigma_h,sigma_v\n";
  std::string control = header, check = header, truth = header;
  bool has_control = false, has_check = false;
  for (const SurveyedPoint& p : points) {
    (p.target.empty() ? check : control) += row(p, p.surveyed, options.sigma.value);
    (p.target.empty() ? has_check : has_control) = true;
    truth += row(p, p.truth, 0.0);
  }
  std::vector<io::ControlFile> files;
  const auto write = [&](const char* name, const std::string& text, io::ControlUse use) {
    io::write_text_file(folder / name, text);
    io::ControlFile f;
    f.file = name;
    f.use = use;
    files.push_back(f);
  };
  if (has_control) write("control.csv", control, io::ControlUse::control);
  if (has_check) write("check.csv", check, io::ControlUse::check);
  if (!points.empty()) io::write_text_file(folder / "truth" / "control.csv", truth);
  return files;
}

}  // namespace swath::simulate
