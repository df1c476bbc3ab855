// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/navigation/chain_cost.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <memory>

#include "calib/block/block_costs.h"

namespace swath::calib {
namespace {

using Eigen::MatrixXd;

constexpr std::array<double, 9> identity{1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr double one = 1.0;

/// A plain equation of three rows within a step: its residual is multiplied by `weight` and added.
struct ChainPart {
  std::unique_ptr<ceres::CostFunction> equation;
  std::vector<size_t> blocks;  // its parameters among those of the step
  MatrixXd weight;             // rows of the step x 3
  const double* factor;
};

class ChainCost : public ceres::CostFunction {
 public:
  ChainCost(std::vector<ChainPart> parts, const std::vector<int>& sizes, int rows) : parts_(std::move(parts)) {
    *mutable_parameter_block_sizes() = {sizes.begin(), sizes.end()};
    set_num_residuals(rows);
  }

  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override {
    const int rows = num_residuals();
    using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Eigen::VectorXd> out(residuals, rows);
    out.setZero();
    const auto& sizes = parameter_block_sizes();
    if (jacobians)
      for (size_t b = 0; b < sizes.size(); ++b)
        if (jacobians[b]) std::fill_n(jacobians[b], rows * sizes[b], 0.0);
    std::vector<std::array<double, 21>> derivative(4);
    for (const ChainPart& p : parts_) {
      std::array<const double*, 4> values{};
      std::array<double*, 4> by{};
      for (size_t k = 0; k < p.blocks.size(); ++k) {
        values[k] = parameters[p.blocks[k]];
        by[k] = jacobians && jacobians[p.blocks[k]] ? derivative[k].data() : nullptr;
      }
      Eigen::Vector3d e;
      if (!p.equation->Evaluate(values.data(), e.data(), jacobians ? by.data() : nullptr)) return false;
      out += p.weight * e / *p.factor;
      for (size_t k = 0; k < p.blocks.size(); ++k)
        if (by[k]) {
          const int size = sizes[p.blocks[k]];
          Eigen::Map<ByRows>(jacobians[p.blocks[k]], rows, size) += p.weight * Eigen::Map<const ByRows>(by[k], 3, size) / *p.factor;
        }
    }
    return true;
  }

 private:
  std::vector<ChainPart> parts_;
};

/// Numbers of parameters, each once.
class Parameters {
 public:
  explicit Parameters(std::vector<double*>& blocks) : blocks_(blocks) {}
  size_t number_of(double* values, int size) {
    const auto found = std::find(blocks_.begin(), blocks_.end(), values);
    if (found != blocks_.end()) return static_cast<size_t>(found - blocks_.begin());
    blocks_.push_back(values), sizes.push_back(size);
    return blocks_.size() - 1;
  }
  std::vector<int> sizes;

 private:
  std::vector<double*>& blocks_;
};

ChainPart station_part(const ChainMember& m, MatrixXd weight, const double* factor, Parameters& parameters) {
  auto* cost = new StationCost{*m.station, identity, m.base, &one, m.u, m.datum ? m.datum_centre : nullptr};
  ChainPart out{nullptr, {parameters.number_of(m.pose, 6), parameters.number_of(m.antenna, 3)}, std::move(weight), factor};
  if (m.datum) {
    out.blocks.push_back(parameters.number_of(m.datum, 7));
    out.equation = std::make_unique<ceres::AutoDiffCostFunction<StationCost, 3, 6, 3, 7>>(cost);
  } else if (m.drift) {
    out.blocks.push_back(parameters.number_of(m.drift, 6));
    out.equation = std::make_unique<ceres::AutoDiffCostFunction<StationCost, 3, 6, 3, 6>>(cost);
  } else {
    out.equation = std::make_unique<ceres::AutoDiffCostFunction<StationCost, 3, 6, 3>>(cost);
  }
  return out;
}

ChainPart attitude_part(const ChainMember& m, MatrixXd weight, const double* factor, Parameters& parameters) {
  auto* cost = new AttitudeCost{*m.observed_local_R_camera, identity, m.base, &one};
  ChainPart out{nullptr, {parameters.number_of(m.pose, 6), parameters.number_of(m.boresight, 3)}, std::move(weight), factor};
  if (m.datum && m.turned) {
    out.blocks.push_back(parameters.number_of(m.datum, 7));
    out.equation = std::make_unique<ceres::AutoDiffCostFunction<AttitudeCost, 3, 6, 3, 7>>(cost);
  } else {
    out.equation = std::make_unique<ceres::AutoDiffCostFunction<AttitudeCost, 3, 6, 3>>(cost);
  }
  return out;
}

}  // namespace

ceres::CostFunction* chain_cost(const NavigationStep& step, const std::vector<ChainMember>& members, const double* station_factor,
                                const double* attitude_factor, std::vector<double*>& blocks) {
  const Eigen::Index d = step.root.rows();
  const MatrixXd inverse = step.root.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(d, d));
  Parameters parameters(blocks);
  std::vector<ChainPart> parts;
  for (size_t k = 0; k < members.size(); ++k) {
    const bool own = k + 1 == members.size();
    const MatrixXd weight = own ? inverse : MatrixXd(-inverse * step.by_before.middleCols(d * static_cast<Eigen::Index>(k), d));
    if (members[k].station) parts.push_back(station_part(members[k], weight.leftCols(3), station_factor, parameters));
    if (members[k].observed_local_R_camera) parts.push_back(attitude_part(members[k], weight.rightCols(3), attitude_factor, parameters));
  }
  return new ChainCost(std::move(parts), parameters.sizes, static_cast<int>(d));
}

}  // namespace swath::calib
