// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/block_system.h"

#include <ceres/ceres.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>
#include <stdexcept>

#include "calib/block/block_costs.h"
#include "calib/block/navigation/chain_cost.h"
#include "core/error.h"
#include "core/geo/frames.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::array<double, 9> by_rows(const Matrix3d& M) {
  return {M(0, 0), M(0, 1), M(0, 2), M(1, 0), M(1, 1), M(1, 2), M(2, 0), M(2, 1), M(2, 2)};
}

/// W with W' W = inverse of the covariance.
std::array<double, 9> whitener(const Matrix3d& covariance) {
  const Eigen::LLT<Matrix3d> llt(covariance);
  if (llt.info() != Eigen::Success) throw std::invalid_argument("a covariance is not positive definite");
  return by_rows(llt.matrixL().solve(Matrix3d::Identity()));
}

}  // namespace

struct BlockSystem::State {
  ImageBlock& block;
  BlockWeights weights;
  ceres::Problem problem;
  // In one array: Ceres eliminates in the order of addresses, and several arrays lie in another order where other memory was taken.
  std::vector<double> parameters;
  std::vector<double*> poses, cameras, boresight, antenna, drifts, points;  // in `parameters`
  double* datum = nullptr;                                                  // shift, rotation, scale
  std::vector<std::array<double, 9>> base;                                  // per image, by rows
  std::vector<Matrix3d> nominal;                                            // body_R_camera
  std::array<double, 3> datum_centre{};
  std::vector<ceres::ResidualBlockId> ids;
  std::vector<double*> order;  // of parameter blocks
  LinearBlock shape;           // without rows

  State(ImageBlock& b, const BlockWeights& w) : block(b), weights(w) {
    if (weights.of_ray.empty()) weights.of_ray.assign(block.rays.size(), 1.0);
    take_values();
    add_parameters();
    add_points();
    add_rays();
    block.chain.empty() ? add_navigation() : add_chain();
    add_priors();
  }

  void take_values();
  void give_values();
  void add_parameters();
  void add_points();
  void add_rays();
  void add_navigation();
  void add_chain();
  void add_priors();
  double drift_time(size_t station) const;
  void add_node(NodeKind kind, size_t index, double* values, int size, const std::vector<int>& components);
  template <class Vector>
  void add_partly(NodeKind kind, size_t index, double* values, int size, const Vector& sigma);
  template <int N, class Vector>
  void add_prior(NodeKind kind, size_t index, double* values, const Vector& sigma);
  void note(ObservationKind kind, size_t index, int rows, int component, ceres::ResidualBlockId id) {
    note_rows(kind, index, rows, component);
    ids.push_back(id);
  }
  /// Of an equation that several observations have in common.
  void note_rows(ObservationKind kind, size_t index, int rows, int component) {
    const size_t row = shape.observations.empty() ? 0 : shape.observations.back().row + static_cast<size_t>(shape.observations.back().rows);
    shape.observations.push_back({kind, static_cast<std::uint32_t>(index), component, row, rows});
  }
};

void BlockSystem::State::take_values() {
  parameters.reserve(6 * block.images.size() + (camera_values + 6) * block.cameras.size() + 6 * block.drifts.size() + 7 +
                     3 * block.points.size());  // pointers into it stay
  const auto put = [&](const auto& v) {
    parameters.insert(parameters.end(), v.data(), v.data() + v.size());
    return parameters.data() + parameters.size() - v.size();
  };
  const Vector3d none = Vector3d::Zero();
  for (const BlockImage& i : block.images) {
    poses.push_back(put(i.position));
    put(none);  // rotation
    base.push_back(by_rows(i.camera_R_local));
  }
  for (const BlockCamera& c : block.cameras) {
    cameras.push_back(put(c.value));
    boresight.push_back(put(none));
    antenna.push_back(put(c.antenna));
    nominal.push_back(c.body_R_camera);
  }
  for (const StationDrift& d : block.drifts) {
    drifts.push_back(put(d.shift));
    put(d.change);
  }
  const StationDatum& s = block.station_datum;
  datum = put(s.shift);
  put(s.rotation);
  parameters.push_back(s.scale);
  datum_centre = {s.centre.x(), s.centre.y(), s.centre.z()};
  for (const BlockPoint& p : block.points) points.push_back(put(p.position));
}

void BlockSystem::State::give_values() {
  for (size_t i = 0; i < poses.size(); ++i) {
    BlockImage& image = block.images[i];
    image.position = Vector3d(poses[i]);
    image.camera_R_local = core::exp_so3(Vector3d(poses[i] + 3)) * image.camera_R_local;
    base[i] = by_rows(image.camera_R_local);
    std::fill_n(poses[i] + 3, 3, 0.0);
  }
  for (size_t i = 0; i < points.size(); ++i) block.points[i].position = Vector3d(points[i]);
  for (size_t c = 0; c < cameras.size(); ++c) {
    block.cameras[c].value = CameraVector(cameras[c]);
    block.cameras[c].antenna = Vector3d(antenna[c]);
    block.cameras[c].body_R_camera = nominal[c] * core::exp_so3(-Vector3d(boresight[c]));
  }
  for (size_t d = 0; d < drifts.size(); ++d) {
    block.drifts[d].shift = Vector3d(drifts[d]);
    block.drifts[d].change = Vector3d(drifts[d] + 3);
  }
  block.station_datum.shift = Vector3d(datum);
  block.station_datum.rotation = Vector3d(datum + 3);
  block.station_datum.scale = datum[6];
}

void BlockSystem::State::add_node(NodeKind kind, size_t index, double* values, int size, const std::vector<int>& components) {
  problem.AddParameterBlock(values, size);
  if (components.empty()) return problem.SetParameterBlockConstant(values);
  std::vector<int> held;
  for (int k = 0; k < size; ++k)
    if (std::find(components.begin(), components.end(), k) == components.end()) held.push_back(k);
  if (!held.empty()) problem.SetManifold(values, new ceres::SubsetManifold(size, held));
  order.push_back(values);
  for (size_t k = 0; k < components.size(); ++k) shape.node_of.push_back(static_cast<int>(shape.nodes.size()));
  shape.nodes.push_back({kind, static_cast<std::uint32_t>(index), shape.unknowns, components});
  shape.unknowns += static_cast<int>(components.size());
}

template <class Vector>
void BlockSystem::State::add_partly(NodeKind kind, size_t index, double* values, int size, const Vector& sigma) {
  std::vector<int> components;
  for (int k = 0; k < size; ++k)
    if (sigma[k] > 0.0) components.push_back(k);
  add_node(kind, index, values, size, components);
}

void BlockSystem::State::add_parameters() {
  for (size_t i = 0; i < poses.size(); ++i) add_node(NodeKind::image, i, poses[i], 6, {0, 1, 2, 3, 4, 5});
  for (size_t c = 0; c < cameras.size(); ++c) {
    const BlockCamera& camera = block.cameras[c];
    add_partly(NodeKind::camera, c, cameras[c], camera_values, camera.sigma);
    add_partly(NodeKind::boresight, c, boresight[c], 3, camera.boresight_sigma);
    add_partly(NodeKind::antenna, c, antenna[c], 3, camera.antenna_sigma);
  }
  for (size_t d = 0; d < drifts.size(); ++d) add_node(NodeKind::drift, d, drifts[d], 6, {0, 1, 2, 3, 4, 5});
  if (block.datum == Datum::shift) add_node(NodeKind::datum, 0, datum, 7, {0, 1, 2});
  if (block.datum == Datum::similarity) add_node(NodeKind::datum, 0, datum, 7, {0, 1, 2, 3, 4, 5, 6});
}

void BlockSystem::State::add_points() {
  const std::vector<char> use = determined_points(block);
  int column = shape.unknowns;
  for (size_t p = 0; p < points.size(); ++p) {
    shape.point_column.push_back(use[p] ? column : -1);
    if (!use[p]) continue;
    problem.AddParameterBlock(points[p], 3);
    order.push_back(points[p]);
    column += 3;
  }
}

void BlockSystem::State::add_rays() {
  for (size_t r = 0; r < block.rays.size(); ++r) {
    const ImageRay& ray = block.rays[r];
    if (shape.point_column[ray.point] < 0) continue;
    const std::uint32_t camera = block.images[ray.image].camera;
    auto* cost = new ceres::AutoDiffCostFunction<RayCost, 2, 6, 3, camera_values>(
        new RayCost{ray.x, ray.y, ray.sigma, base[ray.image].data(), &weights.ray, &weights.of_ray[r], block.cameras[camera].distortion});
    note(ObservationKind::ray, r, 2, 0, problem.AddResidualBlock(cost, nullptr, poses[ray.image], points[ray.point], cameras[camera]));
  }
  for (size_t k = 0; k < block.control.size(); ++k) {
    const BlockControl& c = block.control[k];
    if (c.check || shape.point_column[c.point] < 0) continue;
    for (int i = 0; i < 3; ++i) {
      if (!c.known[static_cast<size_t>(i)]) continue;
      auto* cost = new ceres::AutoDiffCostFunction<ControlCost, 1, 3>(new ControlCost{i, c.position[i], c.sigma[i], &weights.control});
      note(ObservationKind::control, k, 1, i, problem.AddResidualBlock(cost, nullptr, points[c.point]));
    }
  }
}

double BlockSystem::State::drift_time(size_t station) const {
  const int set = block.drift_of.empty() ? -1 : block.drift_of[station];
  if (set < 0) return 0.0;
  const StationDrift& d = block.drifts[static_cast<size_t>(set)];
  return (block.images[block.stations[station].image].time - d.first) / d.span;
}

void BlockSystem::State::add_navigation() {
  for (size_t s = 0; s < block.stations.size(); ++s) {
    const ImageStation& station = block.stations[s];
    const std::uint32_t camera = block.images[station.image].camera;
    double* const pose = poses[station.image];
    const int set = block.drift_of.empty() ? -1 : block.drift_of[s];
    auto* cost = new StationCost{{station.position.x(), station.position.y(), station.position.z()},
                                 whitener(station.covariance),
                                 base[station.image].data(),
                                 &weights.station,
                                 drift_time(s),
                                 block.datum == Datum::none ? nullptr : datum_centre.data()};
    if (block.datum != Datum::none) {
      note(ObservationKind::station, s, 3, 0,
           problem.AddResidualBlock(new ceres::AutoDiffCostFunction<StationCost, 3, 6, 3, 7>(cost), nullptr, pose, antenna[camera], datum));
      continue;
    }
    const auto id =
        set < 0 ? problem.AddResidualBlock(new ceres::AutoDiffCostFunction<StationCost, 3, 6, 3>(cost), nullptr, pose, antenna[camera])
                : problem.AddResidualBlock(new ceres::AutoDiffCostFunction<StationCost, 3, 6, 3, 6>(cost), nullptr, pose, antenna[camera],
                                           drifts[static_cast<size_t>(set)]);
    note(ObservationKind::station, s, 3, 0, id);
  }
  for (size_t a = 0; a < block.attitudes.size(); ++a) {
    const ImageAttitude& attitude = block.attitudes[a];
    const BlockImage& image = block.images[attitude.image];
    const Matrix3d& B = block.cameras[image.camera].body_R_camera;
    auto* cost = new AttitudeCost{by_rows(attitude.local_R_body * B), whitener(B.transpose() * attitude.covariance * B),
                                  base[attitude.image].data(), &weights.attitude};
    double* const pose = poses[attitude.image];
    const auto id = block.datum == Datum::similarity
                        ? problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AttitudeCost, 3, 6, 3, 7>(cost), nullptr, pose,
                                                   boresight[image.camera], datum)
                        : problem.AddResidualBlock(new ceres::AutoDiffCostFunction<AttitudeCost, 3, 6, 3>(cost), nullptr, pose,
                                                   boresight[image.camera]);
    note(ObservationKind::attitude, a, 3, 0, id);
  }
}

void BlockSystem::State::add_chain() {
  std::vector<ChainMember> member(poses.size());
  std::vector<size_t> station_of(poses.size(), 0), attitude_of(poses.size(), 0);
  for (size_t i = 0; i < poses.size(); ++i) {
    const std::uint32_t camera = block.images[i].camera;
    member[i].pose = poses[i], member[i].base = base[i].data();
    member[i].antenna = antenna[camera], member[i].boresight = boresight[camera];
    if (block.datum != Datum::none) member[i].datum = datum, member[i].datum_centre = datum_centre.data();
    member[i].turned = block.datum == Datum::similarity;
  }
  for (size_t s = 0; s < block.stations.size(); ++s) {
    const ImageStation& station = block.stations[s];
    ChainMember& m = member[station.image];
    m.station = {station.position.x(), station.position.y(), station.position.z()};
    m.u = drift_time(s);
    if (!block.drift_of.empty() && block.drift_of[s] >= 0) m.drift = drifts[static_cast<size_t>(block.drift_of[s])];
    station_of[station.image] = s;
  }
  for (size_t a = 0; a < block.attitudes.size(); ++a) {
    const ImageAttitude& attitude = block.attitudes[a];
    const Matrix3d& B = block.cameras[block.images[attitude.image].camera].body_R_camera;
    member[attitude.image].observed_local_R_camera = by_rows(attitude.local_R_body * B);
    attitude_of[attitude.image] = a;
  }
  for (const NavigationStep& step : block.chain) {
    std::vector<ChainMember> members;
    for (const std::uint32_t i : step.before) members.push_back(member[i]);
    members.push_back(member[step.image]);
    std::vector<double*> blocks;
    auto* cost = chain_cost(step, members, &weights.station, &weights.attitude, blocks);
    ids.push_back(problem.AddResidualBlock(cost, nullptr, blocks));
    if (members.back().station) note_rows(ObservationKind::station, station_of[step.image], 3, 0);
    if (members.back().observed_local_R_camera) note_rows(ObservationKind::attitude, attitude_of[step.image], 3, 0);
  }
}

template <int N, class Vector>
void BlockSystem::State::add_prior(NodeKind kind, size_t index, double* values, const Vector& sigma) {
  for (const UnknownNode& node : shape.nodes) {
    if (node.kind != kind || node.index != index) continue;
    for (size_t k = 0; k < node.components.size(); ++k) {
      const int i = node.components[k];
      if (!(sigma[i] < free_value)) continue;
      auto* cost = new ceres::AutoDiffCostFunction<PriorCost, 1, N>(new PriorCost{i, values[i], sigma[i]});
      note(ObservationKind::prior, static_cast<size_t>(node.first) + k, 1, 0, problem.AddResidualBlock(cost, nullptr, values));
    }
  }
}

void BlockSystem::State::add_priors() {
  for (size_t c = 0; c < cameras.size(); ++c) {
    add_prior<camera_values>(NodeKind::camera, c, cameras[c], block.cameras[c].sigma);
    add_prior<3>(NodeKind::boresight, c, boresight[c], block.cameras[c].boresight_sigma);
    add_prior<3>(NodeKind::antenna, c, antenna[c], block.cameras[c].antenna_sigma);
  }
}

BlockSystem::BlockSystem(ImageBlock& block, const BlockWeights& weights) : state_(std::make_unique<State>(block, weights)) {}
BlockSystem::~BlockSystem() = default;

void BlockSystem::weigh(const BlockWeights& weights) {
  State& s = *state_;
  s.weights.ray = weights.ray, s.weights.station = weights.station, s.weights.attitude = weights.attitude,
  s.weights.control = weights.control;
  if (!weights.of_ray.empty()) std::copy(weights.of_ray.begin(), weights.of_ray.end(), s.weights.of_ray.begin());
}

BlockConvergence BlockSystem::solve() {
  constexpr size_t few_images = 40;  // a dense matrix is faster
  State& s = *state_;
  ceres::Solver::Options o;
  o.linear_solver_type = s.poses.size() < few_images ? ceres::DENSE_SCHUR : ceres::SPARSE_SCHUR;
  auto* ordering = new ceres::ParameterBlockOrdering;
  o.linear_solver_ordering.reset(ordering);
  std::vector<double*> all;
  s.problem.GetParameterBlocks(&all);
  for (double* values : all) {
    const bool point = !s.points.empty() && values >= s.points.front() && values <= s.points.back();
    ordering->AddElementToGroup(values, point ? 0 : 1);
  }
  o.num_threads = 1;  // more add in the order in which they are done: the last digits would depend on it
  o.max_num_iterations = 100;
  o.function_tolerance = 1e-14;
  o.parameter_tolerance = 1e-13;
  o.gradient_tolerance = 1e-14;
  o.initial_trust_region_radius = 1e8;  // start values are near: steps are those of Gauss and Newton
  o.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(o, &s.problem, &summary);
  s.give_values();
  return {summary.termination_type == ceres::CONVERGENCE, static_cast<int>(summary.iterations.size()), 2.0 * summary.final_cost,
          summary.message};
}

LinearBlock BlockSystem::linearise() {
  State& s = *state_;
  ceres::Problem::EvaluateOptions o;
  o.parameter_blocks = s.order;
  o.residual_blocks = s.ids;
  ceres::CRSMatrix J;
  LinearBlock out = s.shape;
  double cost = 0.0;
  if (!s.problem.Evaluate(o, &cost, &out.residual, nullptr, &J)) throw std::runtime_error("a block's equations cannot be evaluated");
  out.first.assign(J.rows.begin(), J.rows.end());
  out.column = std::move(J.cols);
  out.value = std::move(J.values);
  return out;
}

int LinearBlock::points() const {
  return static_cast<int>(std::count_if(point_column.begin(), point_column.end(), [](int c) { return c >= 0; }));
}

void find_drift_sets(ImageBlock& block) {
  block.drifts.clear();
  block.drift_of.assign(block.stations.size(), -1);
  block.station_datum.centre.setZero();
  for (const ImageStation& s : block.stations) block.station_datum.centre += s.position / static_cast<double>(block.stations.size());
  if (block.drift_sets == DriftSets::none) return;
  std::map<int, std::pair<double, double>> spans;
  const auto key = [&](const ImageStation& s) { return block.drift_sets == DriftSets::strip ? block.images[s.image].strip : 0; };
  for (const ImageStation& s : block.stations) {
    const double t = block.images[s.image].time;
    const auto [it, is_new] = spans.try_emplace(key(s), t, t);
    it->second = {std::min(it->second.first, t), std::max(it->second.second, t)};
  }
  std::map<int, int> number;
  for (const auto& [strip, span] : spans) {
    if (!(span.second > span.first))
      throw core::Error("all stations of strip " + std::to_string(strip) + " are at one instant: its drift is not determined", "",
                        "a strip needs two stations or more; state drift = \"none\" or \"block\", or another strip number");
    number[strip] = static_cast<int>(block.drifts.size());
    block.drifts.push_back({strip, span.first, span.second - span.first, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}});
  }
  for (size_t i = 0; i < block.stations.size(); ++i) block.drift_of[i] = number.at(key(block.stations[i]));
}

std::vector<char> determined_points(const ImageBlock& block) {
  std::vector<int> rays(block.points.size(), 0), coordinates(block.points.size(), 0);
  for (const ImageRay& r : block.rays) ++rays[r.point];
  for (const BlockControl& c : block.control)
    if (!c.check) coordinates[c.point] += static_cast<int>(std::count(c.known.begin(), c.known.end(), true));
  std::vector<char> out(block.points.size(), 0);
  for (size_t p = 0; p < out.size(); ++p) out[p] = !block.points[p].left_out && (rays[p] >= 2 || (rays[p] == 1 && coordinates[p] >= 3));
  return out;
}

}  // namespace swath::calib
