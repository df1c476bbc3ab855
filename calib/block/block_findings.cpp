// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_findings.h"

#include <algorithm>
#include <cstdio>

#include "core/config/units.h"
#include "core/geo/frames.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

constexpr double limit_w = 3.29;  // 0.1 %
constexpr double hardly = 1e-7;   // pivot below which a value is known much worse than alone

struct Correlated {
  std::vector<std::string> names;
  MatrixXd covariance;
};

constexpr std::array<const char*, camera_values> camera_units{"mm", "mm", "mm", "mm^-2", "mm^-4", "mm^-6", "mm^-1", "mm^-1", "", ""};

CameraFound camera_found(const ReadBlock& read, const BlockConfig& config, const BlockSolution& s, std::uint32_t index) {
  const BlockCamera& c = read.block.cameras[index];
  CameraFound out;
  out.name = c.name;
  for (int k = 0; k < camera_values; ++k)
    out.values.push_back({std::string(camera_keys[static_cast<size_t>(k)]), camera_units[static_cast<size_t>(k)], c.value[k], 0.0, true});
  const core::Attitude turned = core::attitude_of(c.body_R_camera * camera_mounting(config.cameras[index].mount, {}).transpose());
  const Vector3d arm = c.body_R_camera * c.antenna;
  const std::array<const char*, 3> angles{"boresight_roll", "boresight_pitch", "boresight_heading"},
      arms{"antenna_forward", "antenna_right", "antenna_down"};
  const std::array<double, 3> angle{turned.roll, turned.pitch, core::wrap_pi(turned.heading)};
  for (size_t k = 0; k < 3; ++k) out.values.push_back({angles[k], "deg", angle[k] / core::degree, 0.0, true});
  for (size_t k = 0; k < 3; ++k) out.values.push_back({arms[k], "m", arm[static_cast<Eigen::Index>(k)], 0.0, true});
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    const UnknownNode& node = s.linear.nodes[n];
    if (node.index != index || (node.kind != NodeKind::camera && node.kind != NodeKind::boresight && node.kind != NodeKind::antenna))
      continue;
    MatrixXd C = s.inference.nodes[n];
    if (node.kind != NodeKind::camera) C = c.body_R_camera * C * c.body_R_camera.transpose();  // from the camera's axes to the body's
    const size_t base = node.kind == NodeKind::camera ? 0 : node.kind == NodeKind::boresight ? camera_values : camera_values + 3;
    for (size_t k = 0; k < node.components.size(); ++k) {
      CameraValueFound& value = out.values[base + static_cast<size_t>(node.components[k])];
      const auto i = static_cast<Eigen::Index>(k);
      value.held = false;
      value.sigma = std::sqrt(C(i, i)) / (node.kind == NodeKind::boresight ? core::degree : 1.0);
    }
    if (node.kind != NodeKind::camera || C.rows() == 0) continue;
    for (const int k : node.components) out.correlated.emplace_back(camera_keys[static_cast<size_t>(k)]);
    const Eigen::VectorXd root = C.diagonal().cwiseSqrt().cwiseInverse();
    out.correlation = root.asDiagonal() * C * root.asDiagonal();
  }
  return out;
}

void add_drifts(const ReadBlock& read, const BlockSolution& s, BlockFound& out) {
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    const UnknownNode& node = s.linear.nodes[n];
    if (node.kind != NodeKind::drift) continue;
    const StationDrift& d = read.block.drifts[node.index];
    const Eigen::VectorXd sigma = s.inference.nodes[n].diagonal().cwiseSqrt();
    out.drifts.push_back({d.strip, read.block.drift_sets == DriftSets::strip, d.shift, sigma.head<3>(), d.change, sigma.tail<3>(), d.span});
  }
}

void add_datum(const ReadBlock& read, const BlockSolution& s, BlockFound& out) {
  for (size_t n = 0; n < s.linear.nodes.size(); ++n) {
    if (s.linear.nodes[n].kind != NodeKind::datum) continue;
    const StationDatum& d = read.block.station_datum;
    const Eigen::VectorXd sigma = s.inference.nodes[n].diagonal().cwiseSqrt();
    DatumFound found{sigma.size() > 3, d.shift, sigma.head<3>(), d.rotation, Eigen::Vector3d::Zero(), d.scale, 0.0};
    if (found.similarity) found.rotation_sigma = sigma.segment<3>(3), found.scale_sigma = sigma[6];
    out.datum = found;
  }
}

void add_precision(const ReadBlock& read, const BlockSolution& s, BlockFound& out) {
  double plan = 0.0, height = 0.0, n = 0.0;
  for (size_t p = 0; p < read.block.points.size(); ++p) {
    if (s.linear.point_column[p] < 0 || out.unfit.of_point[p]) continue;
    const Matrix3d& C = s.inference.points[p];
    plan += (C(0, 0) + C(1, 1)) / 2.0, height += C(2, 2), n += 1.0;
    out.max_plan = std::max(out.max_plan, std::sqrt((C(0, 0) + C(1, 1)) / 2.0));
    out.max_height = std::max(out.max_height, std::sqrt(C(2, 2)));
  }
  out.points = static_cast<size_t>(n);
  if (n > 0.0) out.plan = std::sqrt(plan / n), out.height = std::sqrt(height / n);
  double position = 0.0, angle = 0.0, images = 0.0;
  for (size_t k = 0; k < s.linear.nodes.size(); ++k) {
    if (s.linear.nodes[k].kind != NodeKind::image) continue;
    position += s.inference.nodes[k].diagonal().head<3>().sum() / 3.0;
    angle += s.inference.nodes[k].diagonal().tail<3>().sum() / 3.0;
    images += 1.0;
  }
  if (images > 0.0) out.station_sigma = std::sqrt(position / images), out.angle_sigma = std::sqrt(angle / images) / core::degree;
}

/// Ground sample distance by the first camera with pixels.
double sample_distance(const ReadBlock& read, const BlockConfig& config) {
  double points = 0.0, images = 0.0;
  for (const BlockPoint& p : read.block.points) points += p.position.z() / static_cast<double>(read.block.points.size());
  for (const BlockImage& i : read.block.images) images += i.position.z() / static_cast<double>(read.block.images.size());
  for (size_t c = 0; c < config.cameras.size(); ++c)
    if (config.cameras[c].pixel) return 1e3 * config.cameras[c].pixel->value / read.block.cameras[c].value[0] * std::abs(images - points);
  return 0.0;
}

std::string said(const ReadBlock& read, const BlockObservation& o, size_t row, std::string& unit, double& by) {
  const ImageBlock& b = read.block;
  static constexpr std::array<const char*, 3> axes{"east", "north", "up"};
  const auto axis = [&](size_t k) { return std::string(axes[k]); };
  const size_t k = row - o.row;
  switch (o.kind) {
    case ObservationKind::ray:
      unit = "um", by = 1e3 * b.rays[o.index].sigma;
      return std::string(k == 0 ? "x" : "y") + " of point " + b.points[b.rays[o.index].point].name + " on image " +
             b.images[b.rays[o.index].image].name;
    case ObservationKind::station:
      if (!b.chain.empty()) {
        unit = "sigmas", by = 1.0;
        return axis(k) + " of the station of image " + b.images[b.stations[o.index].image].name + ", given those before";
      }
      unit = "m", by = std::sqrt(b.stations[o.index].covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)));
      return axis(k) + " of the station of image " + b.images[b.stations[o.index].image].name;
    case ObservationKind::attitude:
      if (!b.chain.empty()) {
        unit = "sigmas", by = 1.0;
        return "rotation about axis " + std::to_string(k + 1) + " of image " + b.images[b.attitudes[o.index].image].name +
               ", given its station and the images before";
      }
      unit = "deg",
      by = std::sqrt(b.attitudes[o.index].covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k))) / core::degree;
      return "rotation about axis " + std::to_string(k + 1) + " of image " + b.images[b.attitudes[o.index].image].name;
    case ObservationKind::control:
      unit = "m", by = b.control[o.index].sigma[o.component];
      return axis(static_cast<size_t>(o.component)) + " of control point " + b.points[b.control[o.index].point].name;
    case ObservationKind::prior:
      unit = "sigmas", by = 1.0;
      return "observed value of the camera";
  }
  return {};
}

void add_tests(const ReadBlock& read, const BlockSolution& s, BlockFound& out) {
  constexpr size_t listed = 25;
  struct Tested {
    float w;
    const BlockObservation* o;
    size_t row;
  };
  std::vector<Tested> tested;
  std::vector<double> inner, outer;
  double squares = 0.0, weighted = 0.0, redundancy = 0.0, rows = 0.0;
  const std::array<double, 5> factor{s.weights.ray, s.weights.station, s.weights.attitude, s.weights.control, 1.0};
  for (const BlockObservation& o : s.linear.observations) {
    const bool ray = o.kind == ObservationKind::ray;
    const double weight = ray ? s.weights.of_ray[o.index] : 1.0, by = ray ? 1e3 * read.block.rays[o.index].sigma * factor[0] : 0.0;
    for (size_t row = o.row; row < o.row + static_cast<size_t>(o.rows); ++row) {
      const double r = static_cast<double>(s.inference.redundancy[row]);
      if (std::abs(s.inference.w[row]) > 3.0f || !ray || weight < 0.5) tested.push_back({s.inference.w[row], &o, row});
      out.rejected += std::abs(s.inference.w[row]) > limit_w;
      if (!ray || weight < 0.5) continue;
      squares += std::pow(s.linear.residual[row] * by, 2), weighted += 1.0;
      redundancy += r, rows += 1.0;
      if (r > 0.05) inner.push_back(delta0 * by / std::sqrt(r)), outer.push_back(static_cast<double>(s.inference.outer[row]));
    }
  }
  if (weighted > 0.0) out.image_rms = std::sqrt(squares / weighted), out.ray_redundancy = redundancy / rows;
  if (!inner.empty()) {
    out.inner = core::median(inner), out.max_inner = *std::max_element(inner.begin(), inner.end());
    out.outer = core::median(outer), out.max_outer = *std::max_element(outer.begin(), outer.end());
  }
  // Without weight first: their w is small by it. Then by size.
  const auto key = [&](const Tested& t) {
    const double lost =
        t.o->kind == ObservationKind::ray && s.weights.of_ray[t.o->index] < 0.5 ? 1.0 / std::sqrt(s.weights.of_ray[t.o->index]) : 1.0;
    return std::abs(static_cast<double>(t.w)) * lost;
  };
  std::sort(tested.begin(), tested.end(), [&](const Tested& a, const Tested& b) { return key(a) > key(b); });
  for (size_t k = 0; k < tested.size() && k < listed && key(tested[k]) > limit_w; ++k) {
    const Tested& t = tested[k];
    SuspectFound found;
    double by = 1.0;
    found.what = said(read, *t.o, t.row, found.unit, by);
    const double root = t.o->kind == ObservationKind::ray ? std::sqrt(s.weights.of_ray[t.o->index]) : 1.0;
    found.residual = s.linear.residual[t.row] * by * factor[static_cast<size_t>(t.o->kind)] / root;
    found.w = static_cast<double>(t.w) / root;
    found.redundancy = static_cast<double>(s.inference.redundancy[t.row]);
    out.suspects.push_back(found);
  }
}

void add_differences(const ReadBlock& read, const BlockSolution& s, BlockFound& out) {
  for (size_t k = 0; k < read.block.control.size(); ++k) {
    const BlockControl& c = read.block.control[k];
    ++(c.check ? out.checks : out.control);
    if (s.linear.point_column[c.point] < 0) continue;
    const Matrix3d R = read.frame.local_R_grid(c.position).transpose();
    out.differences.push_back({read.block.points[c.point].name, c.check, R * (read.block.points[c.point].position - c.position),
                               (R * s.inference.points[c.point] * R.transpose()).diagonal().cwiseSqrt(), c.known});
  }
  static constexpr std::array<const char*, 3> axes{"east", "north", "up"};
  for (size_t a = 0; a < 3; ++a) {
    CheckFound f;
    f.coordinate = axes[a];
    f.gsd = out.gsd;
    double sum = 0.0, squares = 0.0, over = 0.0;
    for (size_t k = 0, d = 0; k < read.block.control.size(); ++k) {
      if (s.linear.point_column[read.block.control[k].point] < 0) continue;
      const PointDifference& p = out.differences[d++];
      if (!p.check || !p.known[a]) continue;
      const auto i = static_cast<Eigen::Index>(a);
      ++f.points;
      sum += p.difference[i], squares += p.difference[i] * p.difference[i];
      over += p.difference[i] * p.difference[i] / (p.sigma[i] * p.sigma[i] + std::pow(read.block.control[k].sigma[i], 2));
    }
    if (f.points == 0) continue;
    const auto n = static_cast<double>(f.points);
    f.mean = sum / n, f.rms = std::sqrt(squares / n), f.over_sigma = std::sqrt(over / n);
    f.sd = n > 1.0 ? std::sqrt(std::max(0.0, (squares - n * f.mean * f.mean) / (n - 1.0))) : 0.0;
    out.check.push_back(f);
  }
}

std::string line(const char* form, double a, double b = 0.0) {
  char text[200];
  std::snprintf(text, sizeof text, form, a, b);
  return text;
}

std::string names_of(const std::vector<std::string>& names) {
  constexpr size_t shown = 5;
  std::string out;
  for (size_t k = 0; k < names.size() && k < shown; ++k) out += (k ? ", " : "") + names[k];
  return names.size() > shown ? out + " and " + std::to_string(names.size() - shown) + " more" : out;
}

void add_sentences(BlockFound& out) {
  for (const CameraFound& c : out.cameras)
    for (const CameraValueFound& v : c.values)
      if (v.name == "f" && !v.held && v.sigma > 1e-3 * v.value)
        out.findings.push_back("the principal distance of " + c.name +
                               line(" is known to %.3f mm only: it is not separated from the flying height", v.sigma) +
                               "; observed stations, flights at two heights or control at different heights separate it");
  for (const CameraFound& c : out.cameras)
    for (Eigen::Index i = 0; i < c.correlation.rows(); ++i)
      for (Eigen::Index j = 0; j < i; ++j)
        if (std::abs(c.correlation(i, j)) > 0.995)
          out.findings.push_back(c.correlated[static_cast<size_t>(i)] + " and " + c.correlated[static_cast<size_t>(j)] + " of " + c.name +
                                 line(" have the correlation %.4f: hold one of them", c.correlation(i, j)));
  if (out.smallest_pivot < hardly) out.findings.push_back(line("the block is hardly determined: smallest pivot %.1e", out.smallest_pivot));
  if (!out.control_without_image.empty())
    out.findings.push_back(
        core::counted(out.control_without_image.size(), "point of the control files is", "points of the control files are") +
        " on no image");
  for (const FactorFound& f : out.factors)
    if (f.estimated && (f.factor > 2.0 || f.factor < 0.5))
      out.findings.push_back("the stated sigmas of " + f.kind + line(" were multiplied by %.2f: check them", f.factor));
  if (out.without_weight > 0)
    out.findings.push_back(std::to_string(out.without_weight) + " image points do not fit and have no weight" +
                           (out.unfit.images.empty()
                                ? ""
                                : "; more than a third of those on " + names_of(out.unfit.images) + ": check their stations and events"));
  if (!out.unfit.control.empty())
    out.findings.push_back("control does not fit image points, which have no weight: " + names_of(out.unfit.control) +
                           "; check coordinates and names, or leave these points out");
  if (!out.unfit.others.empty())
    out.findings.push_back("points that do not fit on two images: " + names_of(out.unfit.others) +
                           "; one name may be given to two points. They are not counted in the precision");
  if (!out.parallel_points.empty())
    out.findings.push_back("points whose rays are parallel are left out: " + names_of(out.parallel_points) +
                           "; measure them in images from other places");
  if (!out.images_without_points.empty())
    out.findings.push_back("images without image points have their observed orientation: " + names_of(out.images_without_points));
  for (const CheckFound& c : out.check)
    if (c.points > 3 && c.over_sigma > 2.0)
      out.findings.push_back("check points differ in " + c.coordinate + line(" by %.1f times their standard deviations", c.over_sigma));
}

}  // namespace

BlockFound findings_of(const ReadBlock& read, const BlockConfig& config, const BlockSolution& s) {
  BlockFound out;
  out.started_from = read.started_from;
  out.images = read.block.images.size(), out.rays = read.block.rays.size();
  out.stations = read.block.stations.size(), out.attitudes = read.block.attitudes.size();
  out.points_left_out = s.points_left_out, out.without_weight = s.without_weight;
  out.observations = s.observations, out.unknowns = s.unknowns, out.redundancy = s.redundancy(), out.sigma0 = s.sigma0();
  out.iterations = static_cast<size_t>(s.convergence.iterations), out.rounds = static_cast<size_t>(s.rounds);
  out.smallest_pivot = s.inference.smallest_pivot;
  out.gsd = sample_distance(read, config);
  static constexpr std::array<const char*, 4> kinds{"image points", "stations", "attitudes", "control"};
  const std::array<double, 4> factors{s.weights.ray, s.weights.station, s.weights.attitude, s.weights.control};
  for (size_t k = 0; k < kinds.size(); ++k)
    if (s.inference.redundancy_of[k] > 0.0)
      out.factors.push_back(
          {kinds[k], factors[k], s.inference.redundancy_of[k], !s.component_estimated.empty() && s.component_estimated[k] != 0});
  for (std::uint32_t c = 0; c < read.block.cameras.size(); ++c) out.cameras.push_back(camera_found(read, config, s, c));
  add_drifts(read, s, out);
  add_datum(read, s, out);
  for (const BlockPoint& p : read.block.points)
    if (p.left_out) out.parallel_points.push_back(p.name);
  out.unfit = unfit_points(read.block, s.weights.of_ray);
  add_precision(read, s, out);
  add_tests(read, s, out);
  add_differences(read, s, out);
  out.control_without_image = read.control_without_image;
  out.images_without_points = read.images_without_points;
  add_sentences(out);
  return out;
}

std::string block_text(const BlockFound& f) {
  char text[240];
  std::snprintf(text, sizeof text, "%zu images, %zu points, %zu image points, %zu stations, %zu control and %zu check points\n", f.images,
                f.points, f.rays, f.stations, f.control, f.checks);
  std::string out = text;
  std::snprintf(text, sizeof text,
                "sigma0 %.3f, redundancy %.0f; image residuals %.2f um; sigma of points %.3f m in plan, %.3f m in height\n", f.sigma0,
                f.redundancy, f.image_rms, f.plan, f.height);
  out += text;
  for (const CheckFound& c : f.check) {
    std::snprintf(text, sizeof text, "check points %-5s %4zu: mean %+.3f, sd %.3f, rms %.3f m\n", c.coordinate.c_str(), c.points, c.mean,
                  c.sd, c.rms);
    out += text;
  }
  for (const std::string& s : f.findings) out += "note: " + s + "\n";
  return out;
}

}  // namespace swath::calib
