// SPDX-License-Identifier: GPL-3.0-or-later
// The eigenvectors with the smallest eigenvalues, by subspace iteration with a factor of the shifted matrix. A mode is named after what it
// moves besides the images: drifts of stations, a camera's values, or nothing (then it is the datum or one image).
#include "calib/block/block_diagnosis.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Modes {
  VectorXd eigenvalues;
  MatrixXd vectors;  // of the unknowns, not scaled
};

Modes smallest_modes(const NodeMatrix& N, int count) {
  constexpr double shift = 1e-9;
  constexpr int rounds = 6;
  const NodeFactor factor(N, shift);
  const auto unscale = factor.scale().asDiagonal();
  const VectorXd inverse = factor.scale().cwiseInverse();
  const int n = N.unknowns();
  MatrixXd Y(n, std::min(count, n));
  for (Eigen::Index j = 0; j < Y.cols(); ++j)
    for (Eigen::Index i = 0; i < n; ++i)
      Y(i, j) = std::sin(static_cast<double>((i + 1) * (j + 2)) * 0.7071 + static_cast<double>(j));  // any start
  MatrixXd applied;
  for (int k = 0; k < rounds; ++k) {
    Y = Eigen::HouseholderQR<MatrixXd>(Y).householderQ() * MatrixXd::Identity(n, Y.cols());
    applied = inverse.asDiagonal() * factor.solve(inverse.asDiagonal() * Y);
    const MatrixXd small = Y.transpose() * applied;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen((small + small.transpose()) / 2.0);
    if (k + 1 == rounds) {
      Modes out{eigen.eigenvalues().cwiseInverse().array() - shift, unscale * (Y * eigen.eigenvectors())};
      return out;
    }
    Y = applied;
  }
  return {};
}

std::string listed(const std::set<std::string>& names) {
  constexpr size_t shown = 6;
  std::string out;
  size_t k = 0;
  for (const std::string& n : names) {
    if (k == shown) return out + " and " + std::to_string(names.size() - shown) + " more";
    out += (k++ ? ", " : "") + n;
  }
  return out;
}

/// What a mode moves.
struct Moves {
  double images = 0.0;              // m: largest move of an image, by position or, at its distance from the ground, by rotation
  std::vector<double> of_image;     // m
  double plan = 0.0, height = 0.0;  // m: largest of a point
  std::set<std::string> strips, values;
  bool datum = false;
};

double height_of(const ImageBlock& block) {
  double points = 0.0, images = 0.0;
  for (const BlockPoint& p : block.points) points += p.position.z() / static_cast<double>(block.points.size());
  for (const BlockImage& i : block.images) images += i.position.z() / static_cast<double>(block.images.size());
  return std::max(1.0, std::abs(images - points));
}

/// The move of an image point at half the principal distance from the middle by one component of a camera, as metres on the ground.
double on_ground(const BlockCamera& camera, size_t component, double change, double distance) {
  static constexpr std::array<int, camera_values> power{0, 0, 0, 3, 5, 7, 2, 2, 1, 1};
  return std::abs(change) * std::pow(camera.value[0] / 2.0, power[component]) / camera.value[0] * distance;
}

void note_values(const ImageBlock& block, const UnknownNode& n, const VectorXd& mode, double distance, double noticed, Moves& out) {
  for (size_t k = 0; k < n.components.size(); ++k) {
    const double x = std::abs(mode[n.first + static_cast<int>(k)]);
    const auto component = static_cast<size_t>(n.components[k]);
    switch (n.kind) {
      case NodeKind::drift:
        if (x > noticed) out.strips.insert(std::to_string(block.drifts[n.index].strip));
        break;
      case NodeKind::camera:
        if (on_ground(block.cameras[n.index], component, x, distance) > noticed)
          out.values.insert(block.cameras[n.index].name + "." + std::string(camera_keys[component]));
        break;
      case NodeKind::boresight:
        if (x * distance > noticed) out.values.insert(block.cameras[n.index].name + ".boresight");
        break;
      case NodeKind::antenna:
        if (x > noticed) out.values.insert(block.cameras[n.index].name + ".antenna");
        break;
      case NodeKind::datum:
        out.datum = out.datum || (component < 3 ? x : x * distance) > noticed;
        break;
      case NodeKind::image:
        break;
    }
  }
}

Moves moves_of(const ImageBlock& block, const BlockNormals& normals, const VectorXd& mode) {
  constexpr double noticed = 0.02;  // of the largest move
  const LinearBlock& l = normals.linear();
  Moves out;
  const double distance = height_of(block);
  for (const UnknownNode& n : l.nodes)
    if (n.kind == NodeKind::image) {
      out.of_image.push_back(std::max(mode.segment(n.first, 3).norm(), distance * mode.segment(n.first + 3, 3).norm()));
      out.images = std::max(out.images, out.of_image.back());
    }
  for (const UnknownNode& n : l.nodes) note_values(block, n, mode, distance, noticed * out.images, out);
  for (size_t p = 0; p < block.points.size(); ++p) {
    if (l.point_column[p] < 0) continue;
    const PointPart part = normals.part(p);
    Eigen::Vector3d move = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < part.nodes.size(); ++i) {
      const auto size = part.begin[i + 1] - part.begin[i];
      move -= part.K.middleRows(part.begin[i], size).transpose() * mode.segment(l.nodes[static_cast<size_t>(part.nodes[i])].first, size);
    }
    out.plan = std::max(out.plan, move.head<2>().norm());
    out.height = std::max(out.height, std::abs(move.z()));
  }
  return out;
}

/// Do the points move in plan, in height?
struct PointMoves {
  bool plan = false, height = false;
};
PointMoves points_of(const Moves& m) {
  constexpr double both = 0.1;  // of the larger move
  const double larger = std::max(m.plan, m.height);
  return {m.plan > both * larger, m.height > both * larger};
}

UndeterminedMode of_drifts(const ImageBlock& block, const std::set<std::string>& strips, PointMoves p) {
  const std::string what = p.plan && p.height ? "heights and plan" : p.height ? "heights" : "plan";
  if (block.drift_sets == DriftSets::strip)
    return {0.0,
            "shift and drift of the stations of each strip leave " + what + " of the points undetermined (strips " + listed(strips) + ")",
            "fly two cross strips, or survey chains of height control points across both ends of the strips; or state drift = \"block\""};
  return {0.0, "shift and drift of the stations leave " + what + " of the points undetermined",
          "survey control points in the block's corners (three with height, two in plan at least), or state drift = \"none\""};
}

UndeterminedMode named(const ImageBlock& block, const Moves& m) {
  if (m.datum)
    return {0.0, "the datum of the stations is not determined by control",
            block.datum == Datum::shift ? "survey a control point in plan and height, or state datum = \"none\""
                                        : "survey three control points with height, two of them in plan, not in one line; or state "
                                          "datum = \"shift\""};
  if (!m.values.empty())
    return {0.0, "values of the camera are not separated from the positions of the images: " + listed(m.values),
            "hold them or state their sigmas; flights at two heights, cross strips and stations separate them"};
  const auto moved = std::count_if(m.of_image.begin(), m.of_image.end(), [&](double x) { return x > 0.05 * m.images; });
  if (moved <= 2 && !m.of_image.empty()) {
    const auto at = static_cast<size_t>(std::max_element(m.of_image.begin(), m.of_image.end()) - m.of_image.begin());
    return {0.0, "image " + block.images[at].name + " is not determined by its image points",
            "measure at least three points that other images see, well spread, or give its attitude"};
  }
  return {0.0, "position, scale or attitude of the whole block (or of a part without common points) is not determined",
          "give stations or control points: three with height, two in plan at least, and tie points between all images"};
}

}  // namespace

std::vector<UndeterminedMode> undetermined_modes(const ImageBlock& block, const LinearBlock& linear, double limit) {
  const BlockNormals normals(linear);
  const Modes modes = smallest_modes(normals.reduced(), 8);
  std::vector<UndeterminedMode> out;
  std::set<std::string> strips;  // those of drifts are named together
  PointMoves points;
  double least = 1.0;
  for (Eigen::Index k = modes.eigenvalues.size(); k-- > 0;) {
    if (modes.eigenvalues[k] > limit) continue;
    const Moves moves = moves_of(block, normals, modes.vectors.col(k));
    const double eigenvalue = std::max(0.0, modes.eigenvalues[k]);
    if (!moves.strips.empty()) {
      const PointMoves p = points_of(moves);
      points = {points.plan || p.plan, points.height || p.height};
      strips.insert(moves.strips.begin(), moves.strips.end());
      least = std::min(least, eigenvalue);
      continue;
    }
    out.push_back(named(block, moves));
    out.back().eigenvalue = eigenvalue;
  }
  if (!strips.empty()) {
    out.insert(out.begin(), of_drifts(block, strips, points));
    out.front().eigenvalue = least;
  }
  return out;
}

void refuse_undetermined(const ImageBlock& block, const LinearBlock& linear, const std::vector<std::uint32_t>& unsound_points) {
  if (!unsound_points.empty()) {
    std::set<std::string> names;
    for (const std::uint32_t p : unsound_points) names.insert(block.points[p].name);
    throw core::Error("points without a position, their rays are parallel: " + listed(names), "",
                      "leave them out, or measure them in more images; one name may be given to two points");
  }
  const auto modes = undetermined_modes(block, linear);
  if (modes.empty())
    throw core::Error("the block is hardly determined: its normal equations are singular to working precision", "",
                      "give more control points, stations or tie points");
  std::string what = modes.front().what;
  std::set<std::string> hints{modes.front().hint};  // modes of one kind differ by the strips that they name
  for (const UndeterminedMode& m : modes)
    if (hints.insert(m.hint).second) what += "; " + m.what;
  throw core::Error(what, "", modes.front().hint);
}

}  // namespace swath::calib
