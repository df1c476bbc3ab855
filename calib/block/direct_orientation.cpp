// SPDX-License-Identifier: GPL-3.0-or-later
// With t the rotation error of the body in north, east, down, R = ned_R_body and l the lever arm:
//   d position = d IMU + t x (R l) + v dtime + R dl,   d camera = R_camera' (t + w dtime) + boresight,
// t = J (d roll, d pitch, d heading), w the rotation of the body.
#include "calib/block/direct_orientation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "calib/block/block_config.h"
#include "calib/block/block_frame.h"
#include "core/config/units.h"
#include "core/error.h"
#include "core/geo/geodesy.h"
#include "core/printable.h"
#include "core/statistics.h"

namespace swath::calib {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// Rotation about north, east, down by changes of roll, pitch and heading.
Matrix3d rotation_by_angles(const core::Attitude& a) {
  Matrix3d J;
  J.col(0) = core::matrix_of({0.0, a.pitch, a.heading}) * Vector3d::UnitX();
  J.col(1) = core::matrix_of({0.0, 0.0, a.heading}) * Vector3d::UnitY();
  J.col(2) = Vector3d::UnitZ();
  return J;
}

/// North, east, down, roll, pitch, heading.
Matrix6 pose_covariance(const trajectory::Trajectory& t, double time) {
  Matrix6 out = Matrix6::Zero();
  const core::CovarianceSeries& series = t.data().covariance;
  if (!series.empty()) {
    const core::CovarianceSeries::Matrix9 C = series.at(time);
    out.topLeftCorner<3, 3>() = C.topLeftCorner<3, 3>();
    out.topRightCorner<3, 3>() = C.topRightCorner<3, 3>();
    out.bottomLeftCorner<3, 3>() = C.bottomLeftCorner<3, 3>();
    out.bottomRightCorner<3, 3>() = C.bottomRightCorner<3, 3>();
    return out;
  }
  const trajectory::PoseSigma s = t.sigma_at(time);
  const std::array<double, 6> sigmas{s.north, s.east, s.down, s.roll, s.pitch, s.heading};
  for (int k = 0; k < 6; ++k) out(k, k) = sigmas[static_cast<size_t>(k)] * sigmas[static_cast<size_t>(k)];
  return out;
}

class DirectSolver {
 public:
  explicit DirectSolver(const core::Crs& crs) : to_map_(core::wgs84_ecef(), crs) {}

  void orient(const trajectory::Trajectory& trajectory, const DirectCamera& camera, double time, double time_sigma,
              DirectImage& out) const {
    const trajectory::Pose pose = *trajectory.pose_at(time);
    const Vector3d& arm = camera.lever_arm;
    const core::Geodetic at = core::geodetic_of(pose.position);
    const Matrix3d ned_R_ecef = core::ecef_R_ned(at.latitude, at.longitude).transpose(), R = ned_R_ecef * pose.ecef_R_body;
    const Vector3d centre = pose.position + pose.ecef_R_body * arm;
    out.attitude = core::attitude_of(R);
    out.orientation.attitude = out.attitude;
    out.orientation.map = to_map_(centre);
    // Grid north where the image is: true north turned back by its bearing on the grid.
    constexpr double step = 10.0;  // m
    const Matrix3d enu = ecef_R_enu(centre);
    const Vector3d way = to_map_(Vector3d(centre + step * enu.col(1))) - out.orientation.map;
    const double turn = std::atan2(way.x(), way.y());
    const Matrix3d ecef_R_grid = enu * Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
    out.orientation.grid_R_camera = ecef_R_grid.transpose() * pose.ecef_R_body * camera.body_R_camera;
    const Matrix3d grid_R_ned = ecef_R_grid.transpose() * ned_R_ecef.transpose(), J = rotation_by_angles(out.attitude);
    out.errors.by_pose.topLeftCorner<3, 3>() = grid_R_ned;
    out.errors.by_pose.topRightCorner<3, 3>() = -grid_R_ned * core::skew(R * arm) * J;
    out.errors.by_pose.bottomRightCorner<3, 3>() = -R.transpose() * J;
    Eigen::Matrix<double, 6, 1> by_time;
    by_time << grid_R_ned * ned_R_ecef * (pose.velocity + pose.ecef_R_body * pose.rate.cross(arm)), -pose.rate;
    out.errors.of_time = time_sigma * by_time;
    Matrix6 to_camera = Matrix6::Identity();
    to_camera.bottomRightCorner<3, 3>() = camera.body_R_camera.transpose();
    const Matrix6 A = out.errors.by_pose;
    Matrix6 C = to_camera * (A * pose_covariance(trajectory, time) * A.transpose() + out.errors.of_time * out.errors.of_time.transpose()) *
                to_camera.transpose();
    for (int k = 0; k < 3; ++k) {
      C(k, k) += std::pow(camera.sigma_lever_arm, 2);
      C(3 + k, 3 + k) += std::pow(camera.sigma_boresight, 2);
    }
    out.orientation.covariance = C;
  }

 private:
  core::Transform to_map_;
};

}  // namespace

DirectCamera direct_camera(const io::SurveyCamera& camera, const std::string& survey) {
  const BlockCamera c = camera_of(config_of(camera), survey);
  const auto known = [](double sigma) { return std::isfinite(sigma) ? sigma : 0.0; };
  return {c.name,
          c.body_R_camera,
          {camera.lever_arm[0].value, camera.lever_arm[1].value, camera.lever_arm[2].value},
          known(c.boresight_sigma.x()),
          known(c.antenna_sigma.x())};
}

std::vector<DirectImage> direct_orientation(const trajectory::Trajectory& trajectory, const std::vector<Exposure>& exposures,
                                            const std::vector<DirectCamera>& cameras, const core::Crs& crs, DirectFound& found) {
  const DirectSolver solver(crs);
  std::vector<DirectImage> out;
  std::vector<double> plan, height, tilt, turn;
  for (const Exposure& e : exposures) {
    ++found.events;
    if (!trajectory.covers(e.time)) {
      ++found.outside;
      continue;
    }
    DirectImage image;
    image.name = e.name, image.camera = e.camera, image.strip = e.strip, image.time = e.time, image.doubtful = e.doubtful,
    image.event = e.event;
    found.doubtful += image.doubtful;
    found.exact += !(e.sigma > 0.0);
    solver.orient(trajectory, cameras[e.camera], image.time, e.sigma, image);
    const Matrix6& C = image.orientation.covariance;
    plan.push_back(std::sqrt((C(0, 0) + C(1, 1)) / 2.0)), height.push_back(std::sqrt(C(2, 2)));
    tilt.push_back(std::sqrt((C(3, 3) + C(4, 4)) / 2.0)), turn.push_back(std::sqrt(C(5, 5)));
    out.push_back(std::move(image));
  }
  if (out.empty())
    throw core::Error("orientation.direct: none of " + core::counted(found.events, "exposure") + " is within the trajectory", "",
                      "check the time scale of the events");
  found.images = out.size();
  found.position = core::median(plan), found.height = core::median(height), found.angle = core::median(tilt),
  found.heading = core::median(turn);
  return out;
}

void direct_correlation(const std::vector<DirectImage>& images, const trajectory::Trajectory& trajectory, const DirectOptions& o,
                        const std::function<void(const CovariancePair&)>& take) {
  const trajectory::ErrorModel model(trajectory.data(), o.errors);
  const auto paired = static_cast<size_t>(o.correlated_images);
  const size_t at_once = std::max<size_t>(paired, 50);
  for (size_t begin = 0; begin < images.size(); begin += at_once) {
    const size_t first = begin - std::min(begin, paired), end = std::min(images.size(), begin + at_once);
    std::vector<double> times;
    for (size_t i = first; i < end; ++i) times.push_back(images[i].time);
    const Eigen::MatrixXd C = model.covariance(times);
    for (size_t i = begin; i < end; ++i)
      for (size_t j = std::max(first, i - std::min(i, paired)); j <= i; ++j) {
        const DirectErrors &a = images[i].errors, &b = images[j].errors;
        const auto row = 6 * static_cast<Eigen::Index>(i - first), column = 6 * static_cast<Eigen::Index>(j - first);
        CovariancePair pair{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), {}};
        pair.value = a.by_pose * C.block<6, 6>(row, column) * b.by_pose.transpose();
        if (i == j || (images[i].event && images[i].event == images[j].event)) pair.value += a.of_time * b.of_time.transpose();
        take(pair);
      }
  }
}

std::string direct_images_csv(const std::vector<DirectImage>& images, const std::vector<DirectCamera>& cameras) {
  std::string out = "name,camera,strip,time,x,y,z,sigma_h,sigma_v,roll,pitch,heading\n";
  for (const DirectImage& i : images) {
    const Matrix6& C = i.orientation.covariance;
    // Given their neighbours, stations of images 0.5 s apart have sigmas of micrometres: rounding must stay below.
    constexpr int finer = 3, metre_decimals = 7;
    const int decimals = plan_decimals(i.orientation.map) + finer;
    char text[320];
    std::snprintf(text, sizeof text, ",%d,%.9f,%.*f,%.*f,%.*f,%.5f,%.5f,%.8f,%.8f,%.8f\n", i.strip, i.time, decimals, i.orientation.map.x(),
                  decimals, i.orientation.map.y(), metre_decimals, i.orientation.map.z(), std::sqrt((C(0, 0) + C(1, 1)) / 2.0),
                  std::sqrt(C(2, 2)), i.attitude.roll / core::degree, i.attitude.pitch / core::degree, i.attitude.heading / core::degree);
    out += core::csv_field(i.name) + "," + core::csv_field(cameras[i.camera].name) + text;
  }
  return out;
}

}  // namespace swath::calib
