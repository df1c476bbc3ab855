// SPDX-License-Identifier: GPL-3.0-or-later
// A block with known truth: strips over hills, images with attitudes of some degrees, noise on all that is observed.
#pragma once

#include <cmath>
#include <random>

#include "calib/block/block_start.h"
#include "calib/block/block_system.h"
#include "calib/block/block_theory.h"
#include "core/geo/frames.h"

namespace swath::calib::test {

struct MadeBlock {
  ImageBlock truth, given;
  Eigen::Vector3d truth_centre = Eigen::Vector3d::Zero();  ///< of the stations
};

struct Making {
  unsigned seed = 1;
  TheoryOptions layout;
  TheoryCase which{"", DriftSets::none, ControlLayout::chains, 0};
  CameraVector camera = CameraVector::Zero();        ///< true distortion and principal point; f is the layout's
  CameraVector camera_sigma = CameraVector::Zero();  ///< as BlockCamera::sigma
  double drift = 0.0;                                ///< m, sigma of shifts and changes
  bool attitudes = false;                            ///< observed, with an unknown boresight
  Eigen::Vector3d boresight{0.01, -0.006, 0.008};    ///< rad
  double attitude_sigma = 1e-4;                      ///< rad
  Datum datum = Datum::none;                         ///< stations and attitudes have that of `stations`
  StationDatum stations;
  double correlation = 0.0;  ///< of the errors of stations and attitudes from each image to the next
  double tilt = 0.02;        ///< rad, of the images about each axis, one sigma
  Making() { layout.strips = 3, layout.images = 6; }
};

inline MadeBlock make_block(const Making& m) {
  std::mt19937 random(m.seed);
  std::normal_distribution<double> normal;
  const auto vector = [&](double sigma) { return Eigen::Vector3d(sigma * normal(random), sigma * normal(random), sigma * normal(random)); };
  MadeBlock out;
  ImageBlock& t = out.truth;
  t = theoretical_block(m.layout, m.which);
  for (int k = 1; k < camera_values; ++k) t.cameras[0].value[k] = m.camera[k];
  t.cameras[0].sigma = m.camera_sigma;
  t.cameras[0].body_R_camera << 1, 0, 0, 0, -1, 0, 0, 0, -1;  // the image's x axis forward, its upper edge to the left
  const Eigen::Matrix3d nominal = t.cameras[0].body_R_camera;
  if (m.attitudes) {
    t.cameras[0].boresight_sigma.setConstant(free_value);
    t.cameras[0].body_R_camera = nominal * core::exp_so3(m.boresight);
  }
  for (BlockPoint& p : t.points) p.position.z() = 60.0 * normal(random);
  for (BlockImage& i : t.images) {
    i.position += vector(20.0);
    i.camera_R_local = core::exp_so3(vector(m.tilt)) * i.camera_R_local;
  }
  for (StationDrift& d : t.drifts) d.shift = vector(m.drift), d.change = vector(m.drift);
  for (ImageRay& r : t.rays) {
    const auto seen = image_of(t.cameras[0].value, t.cameras[0].distortion,
                               t.images[r.image].camera_R_local * (t.points[r.point].position - t.images[r.image].position));
    r.x = seen->x(), r.y = seen->y();
  }
  for (BlockControl& c : t.control) c.position = t.points[c.point].position;
  for (size_t s = 0; s < t.stations.size(); ++s) {
    const BlockImage& i = t.images[t.stations[s].image];
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
    if (t.drift_of[s] >= 0) {
      const StationDrift& d = t.drifts[static_cast<size_t>(t.drift_of[s])];
      moved = d.shift + (i.time - d.first) / d.span * d.change;
    }
    t.stations[s].position = i.position + moved;
  }
  if (m.attitudes)
    for (std::uint32_t i = 0; i < t.images.size(); ++i)
      t.attitudes.push_back({i, t.images[i].camera_R_local.transpose() * t.cameras[0].body_R_camera.transpose(),
                             std::pow(m.attitude_sigma, 2) * Eigen::Matrix3d::Identity()});
  ImageBlock& g = out.given;
  g = t;
  g.datum = m.datum;
  if (m.datum != Datum::none) {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const ImageStation& s : t.stations) centre += s.position / static_cast<double>(t.stations.size());
    out.truth_centre = centre;
    const Eigen::Matrix3d turn = core::exp_so3(m.stations.rotation);
    for (ImageStation& s : g.stations) s.position = centre + (1.0 + m.stations.scale) * turn * (s.position - centre) + m.stations.shift;
    for (ImageAttitude& a : g.attitudes) a.local_R_body = turn * a.local_R_body;
  }
  g.cameras[0].body_R_camera = nominal;
  for (int k = 0; k < camera_values; ++k)
    if (m.camera_sigma[k] > 0.0) g.cameras[0].value[k] = k == 0 ? t.cameras[0].value[0] + 0.02 : 0.0;
  for (ImageRay& r : g.rays) r.x += r.sigma * normal(random), r.y += r.sigma * normal(random);
  Eigen::Vector3d off = Eigen::Vector3d::Zero(), turned = off;
  if (m.correlation > 0.0) off = vector(1.0), turned = vector(1.0);
  const double kept = m.correlation, fresh = std::sqrt(1.0 - kept * kept);
  for (ImageStation& s : g.stations) {
    off = kept * off + fresh * vector(1.0);
    s.position += std::sqrt(s.covariance(0, 0)) * off;
  }
  for (ImageAttitude& a : g.attitudes) {
    turned = kept * turned + fresh * vector(1.0);
    a.local_R_body = a.local_R_body * core::exp_so3(m.attitude_sigma * turned);
  }
  for (BlockControl& c : g.control) c.position += c.sigma.cwiseProduct(vector(1.0));
  start_poses(g);
  intersect_points(g);
  return out;
}

/// A block with a drift per strip, attitudes and a free principal distance and point.
inline ImageBlock block_with_all_unknowns() {
  Making m;
  m.which.drift = DriftSets::strip;
  m.attitudes = true;
  m.camera_sigma.head<3>().setConstant(0.05);
  return make_block(m).given;
}

/// Its observation equations as a dense matrix.
inline Eigen::MatrixXd dense_rows(const LinearBlock& l) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(l.residual.size()), l.unknowns + 3 * l.points());
  for (size_t row = 0; row < l.residual.size(); ++row)
    for (size_t k = l.first[row]; k < l.first[row + 1]; ++k) A(static_cast<Eigen::Index>(row), l.column[k]) = l.value[k];
  return A;
}

}  // namespace swath::calib::test
