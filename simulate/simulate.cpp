// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/simulate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "core/error.h"
#include "core/grid.h"
#include "core/option_visitors.h"
#include "core/trajectory_data.h"
#include "io/geotiff.h"
#include "io/output_file.h"
#include "io/sbet.h"
#include "io/survey.h"
#include "io/text_rows.h"
#include "io/value_file.h"
#include "simulate/errors.h"
#include "simulate/inertial.h"
#include "simulate/laser_file.h"
#include "simulate/scan.h"
#include "simulate/shoot.h"
#include "simulate/survey_file.h"

namespace swath::simulate {
namespace {

using core::Value;
namespace fs = std::filesystem;

constexpr double trajectory_step = 0.005;       // s
constexpr std::int64_t pulses_per_task = 4096;  // one task's returns stay in the cache
constexpr std::int64_t tasks_per_batch = 32;    // batches bound the memory: about 40 MB
constexpr double low_margin = 60.0;             // m below the lowest ground: late outliers

/// Everything a survey is made of.
struct Scenery {
  core::Crs crs;
  core::Geodetic origin;
  double half;  ///< half side of the square that beams reach, m
  World world;
  MapPatch map;
  Flight flight;
  core::GpsTime start;
};

void check(const Options& options) {
  std::vector<core::Fault> faults;
  Options copy = options;
  Options read;
  core::read_options(core::described(read), core::effective_values(core::described(copy)), "", faults);
  core::throw_if_any(faults);
}

Scenery build(const Options& o) {
  const core::Crs crs(o.crs);
  // Boresight and attitude may add 6 degrees to the scan; lines and area may overlap either way.
  const double reach = o.flight.height.value * std::tan(std::min(1.2, widest_angle(o.scanner) + 6 * core::degree)) + 60.0;
  const double swath = 2 * o.flight.height.value * std::tan(widest_angle(o.scanner));
  const double line = o.flight.line_length ? o.flight.line_length->value : o.world.length.value;
  const double across = std::max(0, o.flight.lines - 1) * swath * (1 - o.flight.overlap) + swath;
  const double half = std::max({o.world.length.value, o.world.width.value, line, across}) * 0.71 + reach;

  World world(o.world, o.seed, o.flight.direction, half);
  const core::Geodetic origin{o.latitude.value, o.longitude.value, o.world.ground.value};
  const double high = o.world.ground.value + o.flight.height.value + 30.0;
  if (world.relief().highest() > o.world.ground.value + o.flight.height.value - 10.0)
    throw core::usage_error("the ground may reach " + core::format_quantity(core::Dimension::length, std::round(world.relief().highest())) +
                                ", too near to the flying height",
                            "flight.height", "fly higher, or less relief, slope or area");
  MapPatch map(crs, origin, half, world.relief().lowest() - low_margin, high);
  const std::vector<LinePlan> plan =
      plan_lines(o.flight, o.world, widest_angle(o.scanner) > 0 ? widest_angle(o.scanner) : 0.1, map.convergence());
  // The ellipsoid's curvature: the flight keeps its height above the ellipsoid, as the ground does.
  Flight flight(o.flight, origin, o.world.ground.value + o.flight.height.value, plan, o.flight.wind_from.value + map.convergence(), o.seed);
  return {crs, origin, half, std::move(world), std::move(map), std::move(flight), core::from_week(o.output.week, o.output.start.value)};
}

core::TrajectoryData trajectory_of(const Scenery& s, const TrajectoryErrors* errors) {
  core::TrajectoryData out;
  const auto n = static_cast<std::int64_t>(std::ceil(s.flight.duration() / trajectory_step));
  for (std::int64_t k = 0; k <= n; ++k) {
    const core::GpsTime time = s.start + static_cast<double>(k) * trajectory_step;
    const double t = std::min(time - s.start, s.flight.duration());
    Motion m = s.flight.motion(t);
    if (errors) m = delivered(m, errors->at(t));
    out.time.push_back(s.start + t);
    out.latitude.push_back(m.pose.position.latitude);
    out.longitude.push_back(m.pose.position.longitude);
    out.height.push_back(m.pose.position.height);
    out.roll.push_back(m.pose.attitude.roll);
    out.pitch.push_back(m.pose.attitude.pitch);
    out.heading.push_back(m.pose.attitude.heading);
    out.v_north.push_back(m.velocity.x());
    out.v_east.push_back(m.velocity.y());
    out.v_down.push_back(m.velocity.z());
    if (!errors) continue;
    const auto sigma = [&](std::vector<float>& column, size_t i) { column.push_back(static_cast<float>(errors->sigma()[i])); };
    sigma(out.sigma_north, 0);
    sigma(out.sigma_east, 1);
    sigma(out.sigma_down, 2);
    sigma(out.sigma_roll, 3);
    sigma(out.sigma_pitch, 4);
    sigma(out.sigma_heading, 5);
  }
  return out;
}

void write_text_trajectory(const fs::path& file, const core::TrajectoryData& d, core::TimeScale scale) {
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

io::TrajectoryFile write_trajectory(const Scenery& s, const Options& o, const fs::path& folder) {
  const TrajectoryErrors errors(o.noise, o.seed);
  const core::TrajectoryData data = trajectory_of(s, &errors);
  io::TrajectoryFile f;
  if (o.output.trajectory == TrajectoryOutput::sbet) {
    io::write_sbet(folder / "sbet.out", data);
    f.file = "sbet.out";
    f.time = tags_of(core::TimeScale::gps_week, s.start);
    if (!o.noise.noise_free) {
      io::write_smrmsg(folder / "smrmsg.out", data);
      f.accuracy = "smrmsg.out";
    }
    return f;
  }
  write_text_trajectory(folder / "trajectory.csv", data, o.output.time);
  f.file = "trajectory.csv";
  f.time = tags_of(o.output.time, s.start);
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

io::Survey describe_survey(const Scenery& s, const Options& o, io::LaserFile laser, io::TrajectoryFile trajectory) {
  io::Survey survey;
  survey.name = o.name;
  survey.crs = o.crs;
  survey.scanner.model = model_of(o.scanner.pattern);
  if (o.scanner.pattern == Pattern::conical) survey.scanner.cone_angle = o.scanner.half_angle;
  if (o.scanner.pattern == Pattern::palmer) {
    survey.scanner.shaft_angle = o.scanner.shaft_angle;
    survey.scanner.mirror_tilt = o.scanner.mirror_tilt;
  }
  const DeliveredCalibration d = deliver_calibration(o.mounting, o.noise, o.scanner, o.seed);
  survey.calibration = d.calibration;
  survey.sigma = d.sigma;
  survey.laser = {std::move(laser)};
  survey.trajectory = {std::move(trajectory)};
  const core::GpsTime first = s.start + s.flight.lines().front().start - 0.5 / o.scanner.prf.value;
  const core::TimeScale scale = o.output.time == core::TimeScale::utc_day ? core::TimeScale::gps : o.output.time;
  survey.line_time = tags_of(scale, first);
  // Half a pulse of margin on both sides; the records' times still lack the latency.
  const double margin = 0.5 / o.scanner.prf.value, latency = o.mounting.truth.latency.value;
  for (const Line& l : s.flight.lines()) {
    io::FlightLine f;
    f.id = l.id;
    f.name = l.name;
    f.start = core::Seconds(time_in(scale, s.start + l.start - margin - std::max(0.0, latency)));
    f.end = core::Seconds(f.start.value + (l.end - l.start) + 2 * margin + std::abs(latency));
    survey.lines.push_back(f);
  }
  survey.truth.trajectory = "truth/sbet.out";
  if (o.output.truth_returns) survey.truth.returns = "truth/returns.npy";
  survey.truth.dtm = "truth/dtm.tif";
  survey.truth.calibration = "truth/calibration.json";
  return survey;
}

/// The true ground on a lattice over the area and the swaths of its lines.
core::Grid dtm_of(const Scenery& s, const Options& o) {
  const Eigen::Vector3d& m = s.map.map_origin();
  core::Grid g(core::lattice_of(o.output.dtm_cell.value, m.x() - s.half, m.y() - s.half, m.x() + s.half, m.y() + s.half));
  tbb::parallel_for(0, g.lattice.ny, [&](int j) {
    for (int i = 0; i < g.lattice.nx; ++i) {
      const size_t at = g.lattice.at(i, j);
      g.height[at] = static_cast<float>(s.world.relief().height(g.lattice.centre_x(i) - m.x(), g.lattice.centre_y(j) - m.y()));
      g.reason[at] = core::Void::none;
    }
  });
  return g;
}

struct Counts {
  std::int64_t pulses = 0, returns = 0;
  std::map<int, std::int64_t> by_class, by_number, by_line;
  core::GpsTime first = 0.0;

  void add(const Returns& r) {
    for (size_t i = 0; i < r.size(); ++i) {
      ++by_class[static_cast<int>(r.kind[i])];
      ++by_number[static_cast<int>(r.number[i])];
      ++by_line[static_cast<int>(r.line[i])];
    }
    returns += static_cast<std::int64_t>(r.size());
  }
};

/// All lines in batches of tasks; the batches are written in order, so files do not depend on threads.
Counts fire(const Scenery& s, const Options& o, std::vector<std::unique_ptr<LaserFileWriter>>& files, TruthFile* truth,
            const Progress& progress) {
  const Shooter shooter(o, s.world, s.map, s.flight, s.start);
  Counts counts;
  std::int64_t total = 0;
  for (const Line& line : s.flight.lines()) total += shooter.pulses(line);
  std::vector<Returns> parts(static_cast<size_t>(tasks_per_batch));
  for (const Line& line : s.flight.lines()) {
    const std::int64_t pulses = shooter.pulses(line);
    for (std::int64_t begin = 0; begin < pulses; begin += pulses_per_task * tasks_per_batch) {
      const std::int64_t end = std::min(pulses, begin + pulses_per_task * tasks_per_batch);
      tbb::parallel_for(std::int64_t{0}, tasks_per_batch, [&](std::int64_t task) {
        Returns& part = parts[static_cast<size_t>(task)];
        for_each_column([&](auto column) { (part.*column).clear(); });
        const std::int64_t first = std::min(end, begin + task * pulses_per_task), last = std::min(end, first + pulses_per_task);
        shooter.shoot(line, first, last, part);
      });
      Returns batch;
      for (const Returns& part : parts) append(batch, part);
      for (auto& file : files) file->append(batch);
      if (truth) truth->append(batch);
      counts.add(batch);
      counts.pulses += end - begin;
      if (progress) progress(static_cast<double>(counts.pulses) / static_cast<double>(std::max<std::int64_t>(1, total)));
    }
  }
  return counts;
}

Value counted(const std::map<int, std::int64_t>& counts) {
  Value v = Value::object();
  for (const auto& [key, n] : counts) v[std::to_string(key)] = n;
  return v;
}

template <class S>
Value effective(S options) {
  return core::effective_values(core::described(options));
}

void write_navigation(const Scenery& s, const Options& o, const fs::path& folder) {
  const ImuErrors errors = draw_imu_errors(o.noise.noise_free ? ImuGrade::perfect : o.output.imu, o.seed);
  Value v = Value::object();
  v["gps_week"] = core::week_of(s.start);
  v["time"] = "GPS seconds of week, counting on past its end";
  if (o.output.imu != ImuGrade::none) {
    write_imu(folder / "imu.csv", s.flight, s.start, errors, o.seed);
    v["imu"]["file"] = "imu.csv";
    v["imu"]["rate_hz"] = 1.0 / imu_step;
    v["imu"]["axes"] = "forward, right, down";
    v["imu"]["data"] = "increments over the 5 ms that end at the time stamp";
    v["imu"]["grade"] = core::Codec<ImuGrade>::get(o.output.imu);
  }
  if (o.output.gnss) {
    write_gnss(folder / "gnss.csv", s.flight, s.start, o.mounting.lever_arm_antenna, o.noise.noise_free, o.seed);
    v["gnss"]["file"] = "gnss.csv";
    v["gnss"]["rate_hz"] = 1.0 / gnss_step;
    v["gnss"]["point"] = "antenna phase centre";
    for (const core::Metres& m : o.mounting.lever_arm_antenna) v["gnss"]["lever_arm_antenna_m"].push(m.value);
  }
  if (o.output.imu == ImuGrade::none && !o.output.gnss) return;
  io::write_text_file(folder / "navigation.json", io::to_json(v));
  if (o.output.imu != ImuGrade::none) io::write_text_file(folder / "truth" / "imu.json", io::to_json(value_of(errors)));
}

}  // namespace

Options preset(Scene scene) {
  Options o;
  o.world.scene = scene;
  if (scene == Scene::mixed) return o;
  o.world.length = core::Metres(160);
  o.world.width = core::Metres(120);
  o.flight.lines = 2;
  o.flight.cross_lines = 0;
  o.flight.height = core::Metres(250);
  o.scanner.prf = core::Hertz(3000);
  o.scanner.frequency = core::Hertz(20);
  return o;
}

Value run(const Options& options, const fs::path& folder, const Progress& progress) {
  check(options);
  const Scenery scenery = build(options);
  std::error_code ec;
  fs::create_directories(folder / "truth", ec);
  if (ec) throw core::SystemError("cannot make the folder: " + ec.message(), (folder / "truth").string());

  // Records.
  std::vector<std::unique_ptr<LaserFileWriter>> files;
  for (const Format f : options.output.formats) files.push_back(open_laser_file(folder, f, options));
  std::unique_ptr<TruthFile> truth;
  if (options.output.truth_returns) truth = std::make_unique<TruthFile>(folder / "truth" / "returns.npy");
  const Counts counts = fire(scenery, options, files, truth.get(), progress);
  for (auto& file : files) file->finish();
  if (truth) truth->finish();
  const io::TrajectoryFile trajectory = write_trajectory(scenery, options, folder);
  write_navigation(scenery, options, folder);

  // Truth.
  io::write_sbet(folder / "truth" / "sbet.out", trajectory_of(scenery, nullptr));
  io::write_grid(folder / "truth" / "dtm.tif", dtm_of(scenery, options), options.crs);
  io::write_text_file(folder / "truth" / "calibration.json", io::to_json(effective(options.mounting.truth)));

  // Description.
  const core::GpsTime first = scenery.start + scenery.flight.lines().front().start - options.mounting.truth.latency.value;
  for (size_t i = 0; i < options.output.formats.size(); ++i) {
    const Format f = options.output.formats[i];
    const std::string ending = laser_name(f).extension().string().substr(1);
    const std::string name = i == 0 ? "survey.toml" : "survey_" + ending + ".toml";
    const io::Survey survey = describe_survey(scenery, options, describe_laser_file(f, options, first), trajectory);
    io::write_text_file(folder / name, survey_toml(survey, "# Simulated survey; truth/ holds what is known of it.\n"));
  }
  Value report = Value::object();
  report["pulses"] = counts.pulses;
  report["returns"] = counts.returns;
  report["returns_by_class"] = counted(counts.by_class);
  report["returns_by_number"] = counted(counts.by_number);
  report["returns_by_line"] = counted(counts.by_line);
  report["seconds"] = scenery.flight.duration();
  report["buildings"] = static_cast<std::int64_t>(scenery.world.buildings().size());
  report["trees"] = static_cast<std::int64_t>(scenery.world.trees().size());
  report["wires"] = static_cast<std::int64_t>(scenery.world.wires().size());
  report["largest_map_error_m"] = scenery.map.worst();
  Value all = Value::object();
  all["made"] = report;
  all["options"] = effective(options);
  io::write_text_file(folder / "truth" / "simulation.json", io::to_json(all));
  return report;
}

}  // namespace swath::simulate
