// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_adjust.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "calib/adjust/robust_weight.h"
#include "calib/block/block_diagnosis.h"
#include "calib/block/checks/unfit_points.h"
#include "core/error.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

constexpr int max_rounds = 12;  // of robust weights
constexpr int max_component_rounds = 4;
constexpr double settled = 1e-3;  // change of a weight, or of a factor relative to itself

/// Robust weights from the residuals over their own sigmas; true where one changed. `redundancy`: per row, of the plain adjustment.
/// The residual of a ray that has lost weight grows by 1 / (r + p (1 - r)), r its redundancy and p its weight; that is taken off. Without
/// this factor two rays of a point, one of which yields, become a blunder from 3.5 sigmas on.
bool reweigh(const LinearBlock& l, const std::vector<float>& redundancy, const BlockOptions& o, BlockWeights& weights) {
  constexpr float least = 0.05f;  // a residual with less says too little
  std::vector<double> size(weights.of_ray.size(), 0.0), counted;
  for (const BlockObservation& b : l.observations) {
    if (b.kind != ObservationKind::ray) continue;
    const double root = std::sqrt(weights.of_ray[b.index]);
    for (size_t row = b.row; row < b.row + 2; ++row) {
      if (redundancy[row] < least) continue;
      const double r = static_cast<double>(redundancy[row]);
      const double w = std::abs(l.residual[row]) / root / std::sqrt(r) * (r + weights.of_ray[b.index] * (1.0 - r));
      size[b.index] = std::max(size[b.index], w);
      counted.push_back(w);
    }
  }
  const double scale = core::mad_to_sigma * core::median(counted, 0.0);
  if (!(scale > 0.0)) return false;
  const RobustWeight weight(o.full_weight, o.no_weight);
  bool changed = false;
  for (size_t r = 0; r < size.size(); ++r) {
    double& w = weights.of_ray[r];
    const double now = std::max(no_ray_weight, weight(size[r] / scale));
    changed = changed || std::abs(now - w) > settled;
    w = now;
  }
  return changed;
}

/// Factors by kind; true where one changed.
bool rescale(const BlockInference& inference, const BlockOptions& o, BlockSolution& s) {
  constexpr double enough = 15.0;  // degrees of freedom: a factor is known to a fifth
  const std::array<double*, 4> factors{&s.weights.ray, &s.weights.station, &s.weights.attitude, &s.weights.control};
  const double lost = o.robust ? RobustWeight(o.full_weight, o.no_weight).consistency() : 1.0;
  bool changed = false;
  s.component_estimated.assign(4, 0);
  for (size_t k = 0; k < factors.size(); ++k) {
    if (!(inference.redundancy_of[k] > enough)) continue;
    s.component_estimated[k] = 1;
    const double variance = inference.squares_of[k] / inference.redundancy_of[k] / (k == 0 ? lost : 1.0);
    const double factor = std::clamp(std::sqrt(variance), 0.25, 4.0);
    changed = changed || std::abs(factor - 1.0) > settled;
    *factors[k] = std::clamp(*factors[k] * factor, 1e-3, 1e3);
  }
  return changed;
}

void expect_observations(const ImageBlock& block) {
  if (block.images.empty()) throw core::Error("the block has no image");
  std::vector<int> rays(block.images.size(), 0);
  std::vector<char> attitude(block.images.size(), 0);
  for (const ImageRay& r : block.rays) ++rays[r.image];
  for (const ImageAttitude& a : block.attitudes) attitude[a.image] = 1;
  for (size_t i = 0; i < rays.size(); ++i)
    if (rays[i] < 3 && !attitude[i])
      throw core::Error("image " + block.images[i].name + " has " + std::to_string(rays[i]) + " image points and no observed attitude", "",
                        "measure at least three points that other images see, or leave the image out");
}

void expect_determined(const ImageBlock& block, const LinearBlock& start) {
  const BlockNormals normals(start);
  const NodeFactor factor(normals.reduced());
  BlockInference rough;
  rough.smallest_pivot = factor.smallest_pivot();
  if (!rough.determined()) refuse_undetermined(block, start, {});
}

void expect_sound(const ImageBlock& block, const LinearBlock& linear, const BlockInference& found) {
  if (!found.determined() || !found.unsound_points.empty()) refuse_undetermined(block, linear, found.unsound_points);
}

}  // namespace

double BlockSolution::sigma0() const { return redundancy() > 0.0 ? std::sqrt(square_sum / redundancy()) : 1.0; }

BlockSolution adjust_block(ImageBlock& block, const BlockOptions& o) {
  expect_observations(block);
  find_drift_sets(block);
  BlockSolution out;
  out.weights.of_ray.assign(block.rays.size(), 1.0);
  std::optional<BlockSystem> system(std::in_place, block, out.weights);
  expect_determined(block, system->linearise());
  LinearBlock linear;
  for (;;) {
    out.convergence = system->solve();
    linear = system->linearise();
    out.inference = infer(linear, out.weights.of_ray);
    if (!leave_out_parallel(block, out.inference)) break;
    system.reset();
    system.emplace(block, out.weights);
  }
  expect_sound(block, linear, out.inference);
  const std::vector<float> redundancy = out.inference.redundancy;
  for (int component_round = 0;; ++component_round) {
    bool changed = false;
    for (int round = 0; o.robust && round < max_rounds && reweigh(linear, redundancy, o, out.weights); ++round) {
      system->weigh(out.weights);
      out.convergence = system->solve();
      linear = system->linearise();
      ++out.rounds;
      changed = true;
    }
    if (changed || component_round > 0) {
      out.inference = infer(linear, out.weights.of_ray);
      expect_sound(block, linear, out.inference);
    }
    if (!o.components || component_round == max_component_rounds || !rescale(out.inference, o, out)) break;
    system->weigh(out.weights);
    out.convergence = system->solve();
    linear = system->linearise();
    ++out.rounds;
  }
  if (!out.convergence.converged)
    throw core::Error("the adjustment does not converge (" + out.convergence.text + ")", "",
                      "start values may be far off: check the conventions of angles and image axes, and the strip's direction");
  for (const double squares : out.inference.squares_of) out.square_sum += squares;
  out.observations = linear.residual.size();
  out.unknowns = static_cast<size_t>(linear.unknowns) + 3 * static_cast<size_t>(linear.points());
  out.points_left_out = static_cast<size_t>(std::count(linear.point_column.begin(), linear.point_column.end(), -1));
  out.without_weight = static_cast<size_t>(std::count(out.weights.of_ray.begin(), out.weights.of_ray.end(), no_ray_weight));
  linear.column.clear(), linear.column.shrink_to_fit();
  linear.value.clear(), linear.value.shrink_to_fit();
  out.linear = std::move(linear);
  return out;
}

}  // namespace swath::calib
