// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/trajectory_files.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "io/records/sbet.h"
#include "io/text/text_rows.h"
#include "simulate/errors.h"
#include "simulate/files/laser_file.h"
#include "simulate/line_errors.h"

namespace swath::simulate {
namespace {

constexpr double trajectory_step = 0.005;  // s

/// Errors of the delivered trajectory, those over the whole flight and those of its lines.
struct Errors {
  TrajectoryErrors whole;
  LineErrors lines;
};

/// The flight at every step, with the errors of `errors` where there are any.
core::TrajectoryData trajectory_of(const Flight& flight, core::GpsTime start, const Errors* errors) {
  core::TrajectoryData out;
  const auto n = static_cast<size_t>(std::ceil(flight.duration() / trajectory_step - 1e-9)) + 1;
  for (auto* c :
       {&out.time, &out.latitude, &out.longitude, &out.height, &out.roll, &out.pitch, &out.heading, &out.v_north, &out.v_east, &out.v_down})
    c->resize(n);
  const std::array sigmas{&out.sigma_north, &out.sigma_east, &out.sigma_down, &out.sigma_roll, &out.sigma_pitch, &out.sigma_heading};
  if (errors)
    for (auto* c : sigmas) c->resize(n);
  tbb::parallel_for(size_t{0}, n, [&](size_t k) {
    // The instant that the record's time, a double, really names.
    const core::GpsTime time = start + static_cast<double>(k) * trajectory_step;
    const double t = std::min(time - start, flight.duration());
    Motion m = flight.motion(t);
    if (errors) {
      TrajectoryErrors::At error = errors->whole.at(t);
      const LineErrors::At of_line = errors->lines.at(t);
      for (size_t i = 0; i < 6; ++i) {
        error.value[i] += of_line.value[i];
        error.rate[i] += of_line.rate[i];
        (*sigmas[i])[k] = static_cast<float>(std::hypot(errors->whole.sigma()[i], of_line.sigma[i]));
      }
      m = delivered(m, error);
    }
    out.time[k] = start + t;
    out.latitude[k] = m.pose.position.latitude;
    out.longitude[k] = m.pose.position.longitude;
    out.height[k] = m.pose.position.height;
    out.roll[k] = m.pose.attitude.roll;
    out.pitch[k] = m.pose.attitude.pitch;
    out.heading[k] = m.pose.attitude.heading;
    out.v_north[k] = m.velocity.x();
    out.v_east[k] = m.velocity.y();
    out.v_down[k] = m.velocity.z();
  });
  return out;
}

void write_text_trajectory(const std::filesystem::path& file, const core::TrajectoryData& d, core::TimeScale scale) {
  io::TextRows rows(file,
                    "time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,heading_deg,v_north_mps,v_east_mps,v_down_mps,"
                    "sigma_north_m,sigma_east_m,sigma_down_m,sigma_roll_deg,sigma_pitch_deg,sigma_heading_deg\n");
  for (size_t i = 0; i < d.size(); ++i) {
    rows.shortest(time_in(scale, d.time[i]));
    rows.number(d.latitude[i] / core::degree, 12);
    rows.number(d.longitude[i] / core::degree, 12);
    rows.number(d.height[i], 6);
    for (const auto* c : {&d.roll, &d.pitch, &d.heading}) rows.number((*c)[i] / core::degree, 10);
    for (const auto* c : {&d.v_north, &d.v_east, &d.v_down}) rows.number((*c)[i], 6);
    for (const auto* c : {&d.sigma_north, &d.sigma_east, &d.sigma_down}) rows.number(static_cast<double>((*c)[i]), 5);
    for (const auto* c : {&d.sigma_roll, &d.sigma_pitch, &d.sigma_heading}) rows.number(static_cast<double>((*c)[i]) / core::degree, 7);
    rows.end();
  }
  rows.commit();
}

}  // namespace

core::TrajectoryData true_trajectory(const Flight& flight, core::GpsTime start) { return trajectory_of(flight, start, nullptr); }

io::TrajectoryFile write_trajectory(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const Options& o) {
  const Errors errors{{o.noise, o.seed}, {o.noise, flight.lines(), o.seed}};
  const core::TrajectoryData data = trajectory_of(flight, start, &errors);
  io::TrajectoryFile f;
  if (o.output.trajectory == TrajectoryOutput::sbet) {
    io::write_sbet(folder / "sbet.out", data);
    f.file = "sbet.out";
    f.time = tags_of(core::TimeScale::gps_week, start);
    if (!o.noise.noise_free) {
      io::write_smrmsg(folder / "smrmsg.out", data);
      f.accuracy = "smrmsg.out";
    }
    return f;
  }
  write_text_trajectory(folder / "trajectory.csv", data, o.output.time);
  f.file = "trajectory.csv";
  f.time = tags_of(o.output.time, start);
  f.angle_unit = io::AngleUnit::deg;
  f.columns = {"time_s",           "",
               "latitude_deg",     "longitude_deg",
               "height_m",         "roll_deg",
               "pitch_deg",        "heading_deg",
               "v_north_mps",      "v_east_mps",
               "v_down_mps",       "sigma_north_m",
               "sigma_east_m",     "sigma_down_m",
               "sigma_roll_deg",   "sigma_pitch_deg",
               "sigma_heading_deg"};
  if (o.noise.noise_free)
    for (auto* c : {&f.columns.sigma_north, &f.columns.sigma_east, &f.columns.sigma_down, &f.columns.sigma_roll, &f.columns.sigma_pitch,
                    &f.columns.sigma_heading})
      c->clear();
  return f;
}

}  // namespace swath::simulate
