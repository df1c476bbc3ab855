// SPDX-License-Identifier: GPL-3.0-or-later
#include "calib/block/checks/antenna_offsets.h"

#include <array>
#include <cmath>
#include <cstdio>

namespace swath::calib {
namespace {

using Eigen::Vector3d;

struct MeanResidual {
  double n = 0.0;
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero(), variance = Vector3d::Zero();  ///< of the body's axes

  void add(const Vector3d& residual, const Vector3d& sigma_squared) {
    n += 1.0, sum += residual, squares += residual.cwiseAbs2(), variance += sigma_squared;
  }
  Vector3d mean() const { return sum / n; }
  bool is_off(int k) const {
    constexpr double clear = 5.0;
    const double at = sum[k] / n, own = variance[k] / n, scatter = std::max(own, squares[k] / n - at * at);
    return std::abs(at) > clear * std::sqrt(scatter / n) && std::abs(at) > std::sqrt(own);
  }
};

std::string sentence(const BlockCamera& camera, const MeanResidual& r) {
  static constexpr std::array<const char*, 3> axes{"forward", "right", "down"};
  const Vector3d mean = r.mean(), stated = camera.body_R_camera * camera.antenna;
  std::string turned;
  bool explained = true;
  for (int k = 0; k < 3; ++k) {
    if (!r.is_off(k)) continue;
    const bool by_sign = std::abs(mean[k] + 2.0 * stated[k]) < std::abs(mean[k]) / 3.0;
    explained = explained && by_sign;
    if (by_sign) turned += (turned.empty() ? "" : ", ") + std::string(axes[static_cast<size_t>(k)]);
  }
  char text[200];
  std::snprintf(text, sizeof text, " are on average %+.2f m forward, %+.2f m right, %+.2f m down of the stated antenna", mean.x(), mean.y(),
                mean.z());
  return "the stations of camera " + camera.name + text + (!turned.empty() ? "; the opposite sign of " + turned + " explains it" : "") +
         (explained
              ? ""
              : "; check its axes, the times of the events (late ones show as an offset forward), and the heights of stations and control");
}

}  // namespace

std::vector<std::string> antenna_findings(const ImageBlock& b) {
  constexpr double enough = 5.0;  // stations
  if (b.drift_sets != DriftSets::none || b.datum != Datum::none || !b.chain.empty()) return {};
  std::vector<MeanResidual> of(b.cameras.size());
  for (const ImageStation& s : b.stations) {
    const BlockImage& image = b.images[s.image];
    const BlockCamera& camera = b.cameras[image.camera];
    const Eigen::Matrix3d body_R_local = camera.body_R_camera * image.camera_R_local;
    of[image.camera].add(body_R_local * (s.position - image.position) - camera.body_R_camera * camera.antenna,
                         (body_R_local * s.covariance * body_R_local.transpose()).diagonal());
  }
  std::vector<std::string> out;
  for (size_t c = 0; c < of.size(); ++c)
    if (of[c].n >= enough && b.cameras[c].antenna_sigma.isZero(0.0) && (of[c].is_off(0) || of[c].is_off(1) || of[c].is_off(2)))
      out.push_back(sentence(b.cameras[c], of[c]));
  return out;
}

}  // namespace swath::calib
