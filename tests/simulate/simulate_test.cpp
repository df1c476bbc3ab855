// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/simulate.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "core/block.h"
#include "core/config/option_visitors.h"
#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "io/raster/geotiff.h"
#include "io/records/laser_file.h"
#include "io/records/sbet.h"
#include "io/records/trajectory_file.h"
#include "io/survey/calibration_file.h"
#include "io/survey/read_survey.h"
#include "io/text/npy.h"
#include "io/text/value_file.h"
#include "simulate/world/relief.h"
#include "tests/world/npy_columns.h"
#include "tests/world/support.h"

namespace swath::simulate {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double on_terrain = 5e-5;  // m
constexpr double exact = 1e-5;       // m: truth against the beam's equation

/// Position and attitude between the records of a trajectory, by cubic polynomials through four of them (error below 1e-8 m at 200 Hz).
struct TruePose {
  Vector3d ecef;
  Matrix3d ecef_R_body;
};
TruePose pose_at(const core::TrajectoryData& d, double t) {
  const auto k = static_cast<size_t>(std::clamp<std::ptrdiff_t>(std::upper_bound(d.time.begin(), d.time.end(), t) - d.time.begin() - 2, 0,
                                                                static_cast<std::ptrdiff_t>(d.size()) - 4));
  std::array<double, 4> w{};
  for (size_t i = 0; i < 4; ++i) {
    w[i] = 1.0;
    for (size_t j = 0; j < 4; ++j)
      if (j != i) w[i] *= (t - d.time[k + j]) / (d.time[k + i] - d.time[k + j]);
  }
  Vector3d p = Vector3d::Zero();
  double lat = 0, lon = 0, roll = 0, pitch = 0, heading = 0;
  for (size_t i = 0; i < 4; ++i) {
    p += w[i] * core::ecef_of({d.latitude[k + i], d.longitude[k + i], d.height[k + i]});
    lat += w[i] * d.latitude[k + i];
    lon += w[i] * d.longitude[k + i];
    roll += w[i] * d.roll[k + i];
    pitch += w[i] * d.pitch[k + i];
    heading += w[i] * (d.heading[k] + core::wrap_pi(d.heading[k + i] - d.heading[k]));
  }
  const Matrix3d R = (Eigen::AngleAxisd(heading, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                      Eigen::AngleAxisd(roll, Vector3d::UnitX()))
                         .toRotationMatrix();
  return {p, core::ecef_R_ned(lat, lon) * R};
}

core::TrajectoryData trajectory(const std::filesystem::path& folder) {
  core::Tally tally;
  return io::read_trajectory(io::read_survey(folder / "survey.toml"), tally);
}

TEST(Simulate, TruthIsTheBeamEquationOnTheTerrain) {
  for (const Scene scene : {Scene::mixed, Scene::steep}) {
    const test::TemporaryFolder folder;
    Options o = preset(Scene::hills);
    o.world.scene = scene;
    o.noise.noise_free = true;
    run(o, folder.path());
    const auto truth = test::npy_columns(folder / "truth/returns.npy");
    core::Tally tally;
    io::TimeTags tags;
    tags.scale = core::TimeScale::gps_week;
    tags.week = o.output.week;
    const core::TrajectoryData flown =
        io::read_sbet(folder / "truth/sbet.out", tags, true, io::VelocityAxes::automatic, std::nullopt, tally);
    core::Calibration c;
    core::SensorSigma sigma;
    io::load_calibration(folder / "truth/calibration.json", c, sigma);
    const Matrix3d body_R_scanner =
        (Eigen::AngleAxisd(c.heading.value, Vector3d::UnitZ()) * Eigen::AngleAxisd(c.pitch.value, Vector3d::UnitY()) *
         Eigen::AngleAxisd(c.roll.value, Vector3d::UnitX()))
            .toRotationMatrix();
    const Vector3d lever(c.lever_arm_scanner[0].value, c.lever_arm_scanner[1].value, c.lever_arm_scanner[2].value);
    const core::Transform map_T_ecef(core::wgs84_ecef(), core::Crs(o.crs));
    const Vector3d middle = map_T_ecef(core::ecef_of({o.latitude.value, o.longitude.value, o.world.ground.value}));
    const Relief relief(o.world, o.seed, o.flight.direction, 1000.0);
    const io::Raster dtm = io::read_raster(folder / "truth/dtm.tif");
    const size_t n = truth.at("t").size();
    ASSERT_GT(n, 5000u);
    double worst_equation = 0, worst_map = 0, worst_terrain = 0;
    size_t ground = 0;
    for (size_t i = 0; i < n; i += 7) {
      const TruePose pose = pose_at(flown, truth.at("t")[i]);
      const double a = truth.at("angle")[i];
      const Vector3d r = truth.at("range")[i] * Vector3d(0, std::sin(a), std::cos(a));
      const Vector3d p = pose.ecef + pose.ecef_R_body * (lever + body_R_scanner * r);
      const Vector3d stored(truth.at("X")[i], truth.at("Y")[i], truth.at("Z")[i]);
      const Vector3d map(truth.at("e")[i], truth.at("n")[i], truth.at("h")[i]);
      worst_equation = std::max(worst_equation, (p - stored).norm());
      worst_map = std::max(worst_map, (map_T_ecef(stored) - map).norm());
      if (truth.at("cls")[i] != core::point_class::ground) continue;
      worst_terrain = std::max(worst_terrain, std::abs(relief.height(map.x() - middle.x(), map.y() - middle.y()) - map.z()));
      ++ground;
    }
    EXPECT_LT(worst_equation, exact);
    EXPECT_LT(worst_map, exact);
    EXPECT_LT(worst_terrain, on_terrain);
    EXPECT_GT(ground, n / 30);
    for (int row = 3; row < dtm.ny; row += 41)
      for (int col = 5; col < dtm.nx; col += 37) {
        const double e = dtm.geotransform[0] + (col + 0.5) * dtm.geotransform[1],
                     north = dtm.geotransform[3] + (row + 0.5) * dtm.geotransform[5];
        const double stored = dtm.values[static_cast<size_t>(row) * static_cast<size_t>(dtm.nx) + static_cast<size_t>(col)];
        EXPECT_NEAR(stored, relief.height(e - middle.x(), north - middle.y()), on_terrain);  // a float of 600 m resolves 0.06 mm
      }
  }
}

TEST(Simulate, SameSeedSameBytesWhateverTheThreads) {
  Options o = preset(Scene::town);
  o.output.formats = {Format::npy, Format::csv};
  o.flight.lines = 1;
  o.events.file = true;
  const test::TemporaryFolder one, two, other;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    run(o, one.path());
  }
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    run(o, two.path());
  }
  for (const char* file :
       {"laser.npy", "laser.csv", "sbet.out", "smrmsg.out", "imu.csv", "gnss.csv", "truth/imu_drift.csv", "events_pc.csv", "loopstats",
        "pps.log", "survey.toml", "survey_csv.toml", "truth/returns.npy", "truth/dtm.tif", "truth/cover.tif"})
    EXPECT_EQ(test::read_bytes(one / file), test::read_bytes(two / file)) << file;
  o.seed = 2;
  run(o, other.path());
  EXPECT_NE(test::read_bytes(one / "laser.npy"), test::read_bytes(other / "laser.npy"));
}

TEST(Simulate, EveryPatternAndFormatGivesASurveyThatReads) {
  for (const Pattern pattern : {Pattern::triangle, Pattern::sine, Pattern::polygon, Pattern::profile, Pattern::beam, Pattern::multibeam,
                                Pattern::conical, Pattern::palmer}) {
    const test::TemporaryFolder folder;
    Options o = preset(Scene::flat);
    o.scanner.pattern = pattern;
    o.flight.lines = 1;
    o.imu.file = false;
    o.gnss.file = false;
    o.output.time = core::TimeScale::unix_utc;
    o.output.formats = {Format::csv, Format::npy};
    if (pattern != Pattern::conical && pattern != Pattern::palmer)
      o.output.formats.insert(o.output.formats.end(), {Format::las, Format::laz});
    if (pattern == Pattern::sine) o.output.trajectory = TrajectoryOutput::text;
    const Made made = run(o, folder.path());
    EXPECT_GT(made.laser->returns, 2000u);
    for (const char* name : {"survey.toml", "survey_npy.toml"}) {
      const io::Survey survey = io::read_survey(folder / name);
      EXPECT_EQ(survey.lines.size(), 1u);
      EXPECT_EQ(survey.scanner.model, model_of(pattern));
      const io::LineWindow window = io::line_windows(survey).front();
      const auto truth = test::npy_columns(folder / "truth/returns.npy");
      EXPECT_LT(window.start, truth.at("t").front());
      EXPECT_GT(window.end, truth.at("t").back());
      EXPECT_LT(window.end - window.start, 1.0 + truth.at("t").back() - truth.at("t").front());
    }
    const core::TrajectoryData flown = trajectory(folder.path());
    EXPECT_TRUE(flown.has_sigma());
    EXPECT_GT(flown.size(), 1000u);
  }
}

TEST(Simulate, EveryFormatReadsBackToTheSameShots) {
  for (const Pattern pattern : {Pattern::triangle, Pattern::beam}) {
    const test::TemporaryFolder folder;
    Options o = preset(Scene::forest);
    o.scanner.pattern = pattern;
    o.noise.noise_free = true;
    o.imu.file = false;
    o.output.formats = {Format::csv, Format::npy, Format::las, Format::laz};
    o.output.start = core::Seconds(604690.0);  // the second line is flown in the next week
    o.mounting.truth.latency = core::Seconds(0.25);
    o.scanner.prf = core::Hertz(1000);
    run(o, folder.path());
    const auto truth = test::npy_columns(folder / "truth/returns.npy");
    const core::Calibration& c = o.mounting.truth;
    for (const char* name : {"survey.toml", "survey_npy.toml", "survey_las.toml", "survey_laz.toml"}) {
      const io::Survey survey = io::read_survey(folder / name);
      core::Tally tally;
      const std::vector<io::StripInfo> strips = io::scan(survey, tally);
      ASSERT_EQ(strips.size(), 2u) << name;
      EXPECT_TRUE(tally.empty()) << name;
      size_t row = 0;
      double worst_range = 0, worst_beam = 0, worst_time = 0;
      for (const io::StripInfo& strip : strips) {
        io::LaserSource source(survey, strip);
        core::Shots shots;
        while (source.next(shots, 700)) {
          for (size_t i = 0; i < shots.size(); ++i, ++row) {
            ASSERT_LT(row, truth.at("t").size());
            ASSERT_EQ(shots.return_number[i], truth.at("rn")[row]);
            const double f = shots.forward.empty() ? 0.0 : shots.forward[i], w = std::sqrt(1 - f * f);
            const double a = c.scan_scale * shots.angle[i] + c.scan_offset.value;
            const Vector3d beam(f, w * std::sin(a), w * std::cos(a)),
                expected(truth.at("bx")[row], truth.at("by")[row], truth.at("bz")[row]);
            worst_beam = std::max(worst_beam, (beam - expected).norm() * truth.at("range")[row]);
            worst_range = std::max(worst_range, std::abs(c.range_scale * shots.range[i] + c.range_offset.value - truth.at("range")[row]));
            worst_time = std::max(worst_time, std::abs(shots.time[i] + c.latency.value - truth.at("t")[row]));
          }
        }
      }
      EXPECT_EQ(row, truth.at("t").size()) << name;
      EXPECT_LT(worst_range, 2e-6) << name;  // LAS holds micrometres
      EXPECT_LT(worst_beam, 2e-6) << name;
      EXPECT_LT(worst_time, 5e-7) << name;
    }
  }
}

TEST(Simulate, RecordsMatchTheTruthRowByRow) {
  const test::TemporaryFolder folder;
  const Options o = preset(Scene::forest);
  run(o, folder.path());
  const auto laser = test::npy_columns(folder / "laser.npy"), truth = test::npy_columns(folder / "truth/returns.npy");
  ASSERT_EQ(laser.at("time").size(), truth.at("t").size());
  const double week = core::from_week(o.output.week, 0);
  for (size_t i = 0; i < laser.at("time").size(); ++i) {
    ASSERT_NEAR(laser.at("time")[i] + week, truth.at("t")[i], 1e-6);
    ASSERT_NEAR(laser.at("range")[i], truth.at("range")[i], 0.04 + 6 * o.noise.range.value);
    ASSERT_EQ(laser.at("return_number")[i], truth.at("rn")[i]);
    ASSERT_EQ(laser.at("return_count")[i], truth.at("nr")[i]);
    ASSERT_EQ(laser.at("line")[i], truth.at("line")[i]);
  }
}

io::Survey stated(const std::filesystem::path& file) {
  io::Survey s;
  std::vector<core::Fault> faults;
  core::read_options(core::described(s), io::read_value_file(file), "", faults);
  core::throw_if_any(faults);
  s.folder = file.parent_path();
  return s;
}

TEST(Simulate, TheZooHasEveryClassAndEveryCover) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::zoo);
  o.scanner.prf = core::Hertz(15000);
  const Made made = run(o, folder.path());
  for (const int kind : {2, 3, 4, 5, 6, 7, 9, 14, 17, 18}) {
    ASSERT_TRUE(made.laser->by_class.contains(kind)) << kind;
    EXPECT_GT(made.laser->by_class.at(kind), 5u) << kind;
  }
  EXPECT_GT(made.laser->fields, 10u);
  const io::Raster cover = io::read_raster(folder / "truth/cover.tif"), dtm = io::read_raster(folder / "truth/dtm.tif");
  EXPECT_EQ(cover.geotransform, dtm.geotransform);
  ASSERT_EQ(cover.values.size(), dtm.values.size());
  std::map<double, size_t> cells;
  for (const double v : cover.values) ++cells[v];
  ASSERT_EQ(cells.size(), 7u);
  for (const auto& [value, n] : cells) EXPECT_GT(n, 100u) << value;
  EXPECT_EQ(cells.begin()->first, 1.0);
  EXPECT_EQ(cells.rbegin()->first, 7.0);
}

TEST(Simulate, NavigationAloneNeedsNoWorld) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::hills);
  o.output.laser = false;
  o.output.trajectory = TrajectoryOutput::none;
  o.events.file = true;
  o.flight.still = core::Seconds(30.0);
  o.imu.spec.grade = core::ImuGrade::mems;
  o.imu.spec.gyro_drift = core::RadiansPerSecond(1e-5);
  o.world.length = core::Metres(1e4);  // a world of this size would take minutes
  const Made made = run(o, folder.path());
  for (const char* file : {"laser.npy", "sbet.out", "smrmsg.out", "truth/returns.npy", "truth/dtm.tif"})
    EXPECT_FALSE(std::filesystem::exists(folder / file)) << file;
  for (const char* file : {"imu.csv", "gnss.csv", "events_pc.csv", "events_marks.csv", "loopstats", "pps.log", "truth/sbet.out",
                           "truth/imu.json", "truth/imu_drift.csv", "truth/gnss.csv", "truth/events.csv", "truth/simulation.json"})
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  EXPECT_EQ(made.fixes, 1 + static_cast<std::int64_t>(5 * made.seconds));
  const io::Survey survey = stated(folder / "survey.toml");
  EXPECT_TRUE(survey.laser.empty());
  EXPECT_TRUE(survey.trajectory.empty());
  ASSERT_EQ(survey.imu.size(), 1u);
  ASSERT_EQ(survey.gnss.size(), 1u);
  EXPECT_EQ(survey.events.size(), 2u);
  EXPECT_EQ(survey.clock.size(), 1u);
  EXPECT_EQ(survey.imu_spec.grade, core::ImuGrade::mems);
  EXPECT_NEAR(survey.imu_spec.gyro_drift->value, 1e-5, 1e-18);
  EXPECT_EQ(survey.imu[0].rate, o.imu.rate);
  EXPECT_EQ(survey.antenna.lever_arm, o.mounting.lever_arm_antenna);
  EXPECT_EQ(survey.lines.size(), 2u);
}

TEST(Simulate, FliesAlongAGivenTrajectory) {
  const test::TemporaryFolder folder;
  Options o = preset(Scene::flat);
  o.output.laser = false;
  o.noise.noise_free = true;
  run(o, folder / "first");
  Options along = o;
  io::TrajectoryFile file;
  file.file = folder / "first/truth/sbet.out";
  file.time.scale = core::TimeScale::gps_week;
  file.time.week = o.output.week;
  along.flight.along = {file};
  const Made made = run(along, folder / "second");
  EXPECT_LT(made.departure->worst[0], 1e-3);
  EXPECT_EQ(stated(folder / "second/survey.toml").imu_spec.grade, core::ImuGrade::perfect);  // noise-free
  // The same instants, and nearly the same records.
  const std::string one = test::read_bytes(folder / "first/gnss.csv"), two = test::read_bytes(folder / "second/gnss.csv");
  EXPECT_EQ(std::count(one.begin(), one.end(), '\n'), std::count(two.begin(), two.end(), '\n'));
  EXPECT_NE(two.find("\n474000.200,"), std::string::npos);
}

TEST(Simulate, TrajectoryErrorsAreOfTheirSigmas) {
  double position = 0, height = 0, attitude = 0, heading = 0;
  constexpr int seeds = 5;
  size_t n = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const test::TemporaryFolder folder;
    Options o = preset(Scene::flat);
    o.seed = seed;
    o.noise.correlation = core::Seconds(2);
    o.scanner.prf = core::Hertz(100);
    o.imu.file = false;
    run(o, folder.path());
    const core::TrajectoryData given = trajectory(folder.path());
    core::Tally tally;
    io::TimeTags tags;
    tags.scale = core::TimeScale::gps_week;
    tags.week = o.output.week;
    const core::TrajectoryData truth =
        io::read_sbet(folder / "truth/sbet.out", tags, true, io::VelocityAxes::automatic, std::nullopt, tally);
    ASSERT_EQ(given.size(), truth.size());
    for (size_t i = 0; i < given.size(); i += 50, ++n) {
      const double north = (given.latitude[i] - truth.latitude[i]) * core::meridian_radius(truth.latitude[i]);
      position += std::pow(north / static_cast<double>(given.sigma_north[i]), 2);
      height += std::pow((given.height[i] - truth.height[i]) / static_cast<double>(given.sigma_down[i]), 2);
      attitude += std::pow((given.roll[i] - truth.roll[i]) / static_cast<double>(given.sigma_roll[i]), 2);
      heading += std::pow(core::wrap_pi(given.heading[i] - truth.heading[i]) / static_cast<double>(given.sigma_heading[i]), 2);
    }
  }
  // 5 flights of about 190 s at 2 s of correlation: some 200 independent values, 5 sigma of chance.
  for (const double sum : {position, height, attitude, heading}) EXPECT_NEAR(std::sqrt(sum / static_cast<double>(n)), 1.0, 0.2);
}

TEST(Simulate, ReportsProgressAndCounts) {
  const test::TemporaryFolder folder;
  double last = 0;
  const Made made = run(preset(Scene::forest), folder.path(), [&](double share) {
    EXPECT_GE(share, last);
    last = share;
  });
  EXPECT_EQ(last, 1.0);
  const io::NpyHeader header = io::read_npy_header(folder / "truth/returns.npy");
  EXPECT_EQ(made.laser->returns, header.rows);
  EXPECT_GT(made.laser->by_class.at(5), 1000u);
  EXPECT_GT(made.laser->by_number.at(2), 500u);
  const core::Value file = io::read_value_file(folder / "truth/simulation.json");
  const core::Value& classes = *file.find("made")->find("returns_by_class");
  EXPECT_EQ(classes.items().size(), made.laser->by_class.size());
  EXPECT_EQ(classes.items().front().find("number")->as_int(), made.laser->by_class.begin()->first);
}

}  // namespace
}  // namespace swath::simulate
