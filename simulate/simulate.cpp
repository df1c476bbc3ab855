// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/simulate.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>

#include "core/config/option_visitors.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/geo/same_map.h"
#include "core/grid.h"
#include "io/raster/geotiff.h"
#include "io/raster/height_file.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_file.h"
#include "io/survey/survey.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "simulate/errors.h"
#include "simulate/files/camera_files.h"
#include "simulate/files/camera_tables.h"
#include "simulate/files/control_files.h"
#include "simulate/files/earlier_survey.h"
#include "simulate/files/events.h"
#include "simulate/files/gnss_file.h"
#include "simulate/files/imu_file.h"
#include "simulate/files/laser_file.h"
#include "simulate/files/objects_file.h"
#include "simulate/files/photos.h"
#include "simulate/files/survey_file.h"
#include "simulate/files/trajectory_files.h"
#include "simulate/planned_flight.h"
#include "simulate/recorded_flight.h"
#include "simulate/scan.h"
#include "simulate/shoot.h"
#include "simulate/world/facets.h"

namespace swath::simulate {
namespace {

using core::Value;
namespace fs = std::filesystem;

constexpr std::int64_t pulses_per_task = 4096;  // one task's returns stay in the cache
constexpr std::int64_t tasks_per_batch = 32;    // batches bound the memory: about 40 MB
constexpr double low_margin = 60.0;             // m below the lowest ground: late outliers

/// Everything a survey is made of. World and map are there where laser records are made.
struct Scenery {
  std::unique_ptr<Flight> flight;
  core::GpsTime start = 0.0;
  double half = 0.0;  ///< half side of the square that beams reach, m
  std::optional<World> world{};
  std::optional<MapPatch> map{};
};

void check(const Options& options) {
  std::vector<core::Fault> faults;
  Options copy = options;
  Options read;
  core::read_options(core::described(read), core::effective_values(core::described(copy)), "", faults);
  core::throw_if_any(faults);
}

/// A flight along the trajectory that the options name; its first record is the start.
Scenery along_trajectory(const Options& o) {
  io::Survey here;  // without a folder: names are relative to the working one
  here.trajectory = o.flight.along;
  core::Tally tally;
  const core::TrajectoryData records = io::read_trajectory(here, tally);
  Scenery s;
  s.flight = std::make_unique<RecordedFlight>(records, o.flight.along_knots.value);
  s.start = records.time.front();
  return s;
}

/// Half the swath's angle; a profile's place among other lines is planned as if it had some.
double swath_angle(const ScannerOptions& s) { return widest_angle(s) > 0 ? widest_angle(s) : 0.1; }

/// How far a beam or an image reaches to the side, per metre of height.
double reach_per_height(const Options& o) {
  const double beam = widest_angle(o.scanner), image = o.camera.file ? std::atan(o.camera.reach()) : 0.0;
  return std::tan(std::min(1.2, std::max(beam, image) + 6 * core::degree));
}

/// Half side of the square that beams reach, m, over level ground. Boresight and attitude may add 6 degrees to the scan; lines and area may
/// overlap either way.
double reach_of(const Options& o, const Eigen::Vector2d& middle) {
  const FlightOptions& f = o.flight;
  const double reach = f.highest(o.world.ground.value) * reach_per_height(o) + 60.0;
  if (!f.line.empty()) {
    double farthest = 0.0;
    for (const LineOptions& l : f.line)
      for (const auto& end : {l.from, l.to})
        farthest = std::max({farthest, std::abs(end[0].value - middle.x()), std::abs(end[1].value - middle.y())});
    return farthest + reach;
  }
  const double area = std::max(o.world.length.value, o.world.width.value);
  if (f.pattern == FlightPattern::calibration) {
    double farthest = 0.71 * area;
    for (const LinePlan& l : plan_lines(f, o.world, swath_angle(o.scanner), 0.0))
      farthest = std::max({farthest, l.from.lpNorm<Eigen::Infinity>(), l.to.lpNorm<Eigen::Infinity>()});
    return farthest + reach;
  }
  const double swath = 2 * f.height.value * std::tan(widest_angle(o.scanner));
  const double line = f.line_length ? f.line_length->value : o.world.length.value;
  const double across = (f.lines.value_or(3) - 1) * swath * (1 - f.overlap) + swath;
  return std::max({area, line, across}) * 0.71 + reach;
}

/// The ground that the options name, and how much farther beams reach where it is low.
World world_on(const Options& o, const Eigen::Vector2d& middle, double& half) {
  if (!o.world.dem) return World(o.world, o.seed, o.flight.direction, half);
  const core::Box wide = core::Box{middle.x(), middle.y(), middle.x(), middle.y()}.grown(2.0 * half);
  io::HeightFile dem = io::read_heights(*o.world.dem, wide);
  const core::Crs map = core::Crs(o.crs).horizontal();
  if (!dem.crs.empty() && !core::is_same_map(dem.crs, map))
    throw core::usage_error("the terrain model is in " + dem.crs.name() + ", the survey in " + map.name(), "world.dem",
                            "set crs to that of the model, or warp the model (gdalwarp)");
  half = std::min(2.0 * half, half + std::max(0.0, o.world.ground.value - dem.field.lowest()) * reach_per_height(o));
  return World(o.world, Relief(std::move(dem.field), middle), o.seed, o.flight.direction, half);
}

Scenery build(const Options& o) {
  const core::Crs crs(o.crs);
  if (!o.flight.along.empty()) return along_trajectory(o);
  const core::Geodetic origin{o.latitude.value, o.longitude.value, o.world.ground.value};
  const double ground = o.world.ground.value, flown = ground + o.flight.height.value;
  const double highest = ground + o.flight.highest(ground);
  const Eigen::Vector2d middle =
      core::Transform(core::wgs84_geodetic(), crs)(Eigen::Vector3d(core::to_degrees(o.longitude), core::to_degrees(o.latitude), ground))
          .head<2>();
  Scenery s;
  s.half = reach_of(o, middle);
  s.start = core::from_week(o.output.week, o.output.start.value);
  double low = ground;
  if (o.output.laser || o.camera.file) {
    s.world.emplace(world_on(o, middle, s.half));
    low = s.world->relief().lowest() - low_margin;
    if (s.world->relief().highest() > ground + o.flight.lowest(ground) - 10.0)
      throw core::usage_error("the ground may reach " +
                                  core::format_quantity(core::Dimension::length, std::round(s.world->relief().highest())) +
                                  ", too near to the flying height",
                              "flight.height", "fly higher, or less relief, slope or area");
  }
  // Without laser the map serves for the bearing of its grid north alone.
  s.map.emplace(crs, origin, s.world ? s.half : 100.0, low, highest + 30.0);
  const double convergence = s.map->convergence();
  const std::vector<LinePlan> plan = o.flight.line.empty() ? plan_lines(o.flight, o.world, swath_angle(o.scanner), convergence)
                                                           : given_lines(o.flight.line, crs, LocalPlane(origin, flown), flown);
  // The ellipsoid's curvature: the flight keeps its height above the ellipsoid, as the ground does.
  s.flight = std::make_unique<PlannedFlight>(o.flight, origin, flown, plan, o.flight.wind_from.value + convergence, o.seed);
  return s;
}

/// All but laser and trajectory files.
io::Survey describe_survey(const Scenery& s, const Options& o) {
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
  if (o.imu.file) {
    survey.imu = {describe_imu_file(o.imu, s.start)};
    survey.imu_spec = imu_spec_of(o.imu, o.noise.noise_free);
  }
  if (o.gnss.file) {
    survey.gnss = {describe_gnss_file(o.gnss, s.start)};
    survey.antenna = describe_antenna(o.gnss, o.mounting.lever_arm_antenna);
  }
  if (o.events.file) {
    survey.clock = describe_clocks();
    survey.events = describe_events(*s.flight, s.start, o.events, o.seed);
  }
  const core::GpsTime first = s.start + s.flight->lines().front().start - 0.5 / o.scanner.prf.value;
  const core::TimeScale scale = o.output.time == core::TimeScale::utc_day ? core::TimeScale::gps : o.output.time;
  survey.line_time = tags_of(scale, first);
  // Half a pulse of margin on both sides; the records' times still lack the latency.
  const double margin = 0.5 / o.scanner.prf.value, latency = o.mounting.truth.latency.value;
  for (const Line& l : s.flight->lines()) {
    io::FlightLine f;
    f.id = l.id;
    f.name = l.name;
    f.start = core::Seconds(time_in(scale, s.start + l.start - margin - std::max(0.0, latency)));
    f.end = core::Seconds(f.start.value + (l.end - l.start) + 2 * margin + std::abs(latency));
    survey.lines.push_back(f);
  }
  survey.truth.trajectory = "truth/sbet.out";
  if (o.output.laser && o.output.truth_returns) survey.truth.returns = "truth/returns.npy";
  if (o.output.laser) survey.truth.dtm = "truth/dtm.tif";
  survey.truth.calibration = "truth/calibration.json";
  return survey;
}

/// The true ground on a lattice over the area and the swaths of its lines.
core::Grid dtm_of(const Scenery& s, const Options& o) {
  const Eigen::Vector3d& m = s.map->map_origin();
  core::Grid g(core::lattice_of(o.output.dtm_cell.value, m.x() - s.half, m.y() - s.half, m.x() + s.half, m.y() + s.half));
  tbb::parallel_for(0, g.lattice.ny, [&](int j) {
    for (int i = 0; i < g.lattice.nx; ++i) {
      const size_t at = g.lattice.at(i, j);
      g.height[at] = static_cast<float>(s.world->relief().height(g.lattice.centre_x(i) - m.x(), g.lattice.centre_y(j) - m.y()));
      g.reason[at] = core::Void::none;
    }
  });
  return g;
}

/// What covers the ground at the cells of `on` (Cover).
std::vector<float> cover_of(const Scenery& s, const core::Lattice& on) {
  const Eigen::Vector3d& m = s.map->map_origin();
  std::vector<float> cover(static_cast<size_t>(on.nx) * static_cast<size_t>(on.ny));
  tbb::parallel_for(0, on.ny, [&](int j) {
    for (int i = 0; i < on.nx; ++i)
      cover[on.at(i, j)] = static_cast<float>(s.world->cover_at(on.centre_x(i) - m.x(), on.centre_y(j) - m.y()));
  });
  return cover;
}

void count(const Returns& r, LaserMade& made) {
  for (size_t i = 0; i < r.size(); ++i) {
    ++made.by_class[static_cast<int>(r.kind[i])];
    ++made.by_number[static_cast<int>(r.number[i])];
    ++made.by_line[static_cast<int>(r.line[i])];
  }
  made.returns += r.size();
}

/// All lines in batches of tasks; the batches are written in order, so files do not depend on threads.
void fire(const Scenery& s, const Options& o, std::vector<std::unique_ptr<LaserFileWriter>>& files, TruthFile* truth, LaserMade& made,
          const Progress& progress) {
  const Shooter shooter(o, *s.world, *s.map, *s.flight, s.start);
  std::int64_t total = 0;
  for (const Line& line : s.flight->lines()) total += shooter.pulses(line);
  std::vector<Returns> parts(static_cast<size_t>(tasks_per_batch));
  for (const Line& line : s.flight->lines()) {
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
      count(batch, made);
      made.pulses += static_cast<std::uint64_t>(end - begin);
      if (progress) progress(static_cast<double>(made.pulses) / static_cast<double>(std::max<std::int64_t>(1, total)));
    }
  }
}

template <class S>
Value effective(S options) {
  return core::effective_values(core::described(options));
}

void write_navigation(const Scenery& s, const Options& o, const fs::path& folder, io::Survey& survey, Made& made) {
  const bool noise_free = o.noise.noise_free;
  if (o.imu.file) write_imu(folder, *s.flight, s.start, o.imu, noise_free, o.seed);
  if (o.gnss.file) made.fixes = write_gnss(folder, *s.flight, s.start, o.gnss, o.mounting.lever_arm_antenna, noise_free, o.seed);
  if (o.events.file) made.events = write_events(folder, *s.flight, s.start, o.events, noise_free, o.seed);
  if (o.camera.file) {
    const CameraMade camera = write_camera(folder, *s.world, *s.map, *s.flight, s.start, o);
    made.images = camera.images, made.image_points = camera.image_points;
    if (o.events.file) describe_camera(o, camera, survey);
    if (o.camera.photos) write_photos(folder, *s.world, *s.map, *s.flight, o);
  }
}

/// Returns and the terrain's truth.
void write_laser(const Scenery& s, const Options& o, const fs::path& folder, const Progress& progress, LaserMade& made) {
  std::vector<std::unique_ptr<LaserFileWriter>> files;
  for (const Format f : o.output.formats) files.push_back(open_laser_file(folder, f, o));
  std::unique_ptr<TruthFile> truth;
  if (o.output.truth_returns) truth = std::make_unique<TruthFile>(folder / "truth" / "returns.npy");
  fire(s, o, files, truth.get(), made, progress);
  for (auto& file : files) file->finish();
  if (truth) truth->finish();
  const core::Grid dtm = dtm_of(s, o);
  io::write_grid(folder / "truth" / "dtm.tif", dtm, o.crs);
  const std::vector<float> cover = cover_of(s, dtm.lattice);
  io::write_raster(folder / "truth" / "cover.tif", dtm.lattice, {{"cover", "", &cover}}, o.crs, false);
  made.buildings = s.world->buildings().size();
  made.trees = s.world->trees().size();
  made.wires = s.world->wires().size();
  made.fields = static_cast<std::uint64_t>(
      std::count_if(s.world->fields().begin(), s.world->fields().end(), [](const Field& f) { return f.height > 0.0; }));
  made.largest_map_error = s.map->worst();
}

/// Facets of the buildings, and what was surveyed of them and of the ground. Returns what survey.toml says of it.
std::vector<io::ControlFile> write_ground_truth(const Scenery& s, const Options& o, const fs::path& folder, LaserMade& made) {
  const std::vector<Facet> facets = facets_of(*s.world);
  write_planes(folder / "truth" / "planes.csv", facets, *s.map);
  write_objects(folder / "truth", *s.world, *s.map);
  const std::vector<SurveyedPoint> points = survey_points(o, *s.world, facets);
  made.surveyed_points = points.size();
  return write_control(folder, points, o.control, *s.map);
}

/// survey.toml for the first format of laser records, and one for each further one.
void write_surveys(const Scenery& s, const Options& o, const io::Survey& survey, const fs::path& folder) {
  const std::string comment = std::string(simulated_mark) + "; truth/ holds what is known of it.\n";
  if (!o.output.laser) return io::write_text_file(folder / "survey.toml", survey_toml(survey, comment));
  const core::GpsTime first = s.start + s.flight->lines().front().start - o.mounting.truth.latency.value;
  for (size_t i = 0; i < o.output.formats.size(); ++i) {
    io::Survey one = survey;
    one.laser = {describe_laser_file(o.output.formats[i], o, first)};
    const std::string ending = laser_name(o.output.formats[i]).extension().string().substr(1);
    io::write_text_file(folder / (i == 0 ? "survey.toml" : "survey_" + ending + ".toml"), survey_toml(one, comment));
  }
}

}  // namespace

Made run(const Options& given, const fs::path& folder, const Progress& progress) {
  check(given);
  Options options = given;
  options.mounting.truth = true_calibration(given.mounting, given.seed);
  const Scenery scenery = build(options);
  if (options.gnss.file && !Receiver(*scenery.flight, options.gnss, options.mounting.lever_arm_antenna, true, options.seed).next())
    throw core::usage_error("the outages leave no GNSS fix", "gnss.outage", "shorter outages, or gnss.file = false");
  std::error_code ec;
  fs::create_directories(folder / "truth", ec);
  if (ec) throw core::SystemError("cannot make the folder: " + ec.message(), (folder / "truth").string());

  Made made;
  io::Survey survey = describe_survey(scenery, options);
  if (options.output.laser) {
    survey.control = write_ground_truth(scenery, options, folder, made.laser.emplace());
    write_laser(scenery, options, folder, progress, *made.laser);
  }
  write_navigation(scenery, options, folder, survey, made);
  if (options.output.trajectory != TrajectoryOutput::none)
    survey.trajectory = {write_trajectory(folder, *scenery.flight, scenery.start, options)};
  io::write_sbet(folder / "truth" / "sbet.out", true_trajectory(*scenery.flight, scenery.start));
  io::write_text_file(folder / "truth" / "calibration.json", io::to_json(effective(options.mounting.truth)));
  write_surveys(scenery, options, survey, folder);

  made.seconds = scenery.flight->duration();
  made.lines = scenery.flight->lines().size();
  if (const auto* along = dynamic_cast<const RecordedFlight*>(scenery.flight.get())) made.departure = along->departure();
  const Value all(Value::Object{{"made", core::reported(made)}, {"options", effective(given)}});
  io::write_text_file(folder / "truth" / "simulation.json", io::to_json(all));
  if (progress) progress(1.0);
  return made;
}

}  // namespace swath::simulate
