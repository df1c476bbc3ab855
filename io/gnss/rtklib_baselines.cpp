// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/rtklib_baselines.h"

#include <cstdio>
#include <vector>

#include "core/error.h"
#include "core/statistics.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_pos.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

constexpr double dynamics_step = 2.0;  // s; with longer ones RTKLIB's prediction falls outside its own gate
constexpr double check_step = 30.0;    // s between the fixes of a receiver by itself

std::string tenths(double value) {
  char text[48];
  std::snprintf(text, sizeof text, "%.1f", value);
  return text;
}

/// A receiver's own solution by code, an epoch per half minute. The files of it do not stay.
core::GnssData alone(const RtklibJob& shared, const Receiver& receiver) {
  const FinishedFiles removed_again;
  RtklibJob job = shared;
  job.products /= ".alone";
  job.name = "alone";
  job.rover = receiver.files;
  job.base.clear();
  job.setup.base.reset();
  job.setup.rover_antenna = {};
  job.antenna_file.reset();
  job.every = receiver.interval < check_step ? check_step : 0.0;
  if (receiver.last - receiver.first < 4 * check_step) job.every = 0;
  job.options.direction = RtklibDirection::forward;
  job.options.coordinates = RtklibCoordinates::ecef;
  job.options.ionosphere = RtklibIonosphere::broadcast;
  job.options.troposphere = RtklibTroposphere::saastamoinen;
  const struct Cleaner {
    fs::path folder;
    ~Cleaner() {
      std::error_code ignored;
      fs::remove_all(folder, ignored);
    }
  } cleaner{job.products};
  core::Tally ignored;
  return read_pos(run_rtklib(job), {}, 0.0, ignored);
}

}  // namespace

void share_files(const Survey& survey, const Receiver& rover, RtklibJob& job, core::Tally& tally) {
  const Rinex& r = survey.rinex;
  bool navigation = false, orbits = false;
  for (const fs::path& name : r.navigation) {
    job.navigation.push_back(resolve(survey, name));
    const RinexKind kind = rinex_kind(job.navigation.back());
    if (kind == RinexKind::observations || kind == RinexKind::other)
      throw core::Error("is no navigation file", job.navigation.back().string(),
                        "[rinex] navigation takes RINEX navigation files, SP3 orbits and RINEX clocks, unpacked");
    navigation = navigation || kind == RinexKind::navigation;
    orbits = orbits || kind == RinexKind::orbits;
  }
  job.setup.precise_orbits = job.options.orbits == RtklibOrbits::precise || (job.options.orbits == RtklibOrbits::automatic && orbits);
  if (job.setup.precise_orbits && !orbits)
    throw core::usage_error("gnss.rtklib: orbits = \"precise\", but [rinex] navigation names no SP3 file", survey.name);
  if (!job.setup.precise_orbits && !navigation)
    throw core::usage_error("gnss.rtklib: [rinex] navigation names no RINEX navigation file", survey.name,
                            "broadcast orbits come from navigation files (N, G, H or mixed)");
  if (job.options.dynamics && rover.interval > dynamics_step)
    throw core::usage_error("gnss.rtklib: dynamics with an epoch every " + core::format_number(rover.interval) + " s",
                            rover.files.front().string(), "RTKLIB's prediction needs an epoch per 2 s or more: dynamics = false");
  if (r.antenna_file) job.antenna_file = resolve(survey, *r.antenna_file);
  job.setup.rover_antenna.type = antenna_type(job.antenna_file, r.antenna_type, rover, "the rover");
  for (size_t k = 0; k < 3; ++k) job.setup.rover_antenna.offset[static_cast<int>(k)] = r.antenna_offset[k].value;
  if (r.antenna_file && job.setup.rover_antenna.type.empty())
    tally.count("antenna without a type: its phase centre is not applied", "the rover");
}

Eigen::Vector3d approximate_place(const Receiver& rover, const RtklibJob& job, std::string& from) {
  from = "RINEX header";
  if (rover.header.position) return *rover.header.position;
  from = "first fix by code";
  try {
    return alone(job, rover).position.front();
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    throw core::Error("the RINEX header has no approximate position, and no fix was found from code: " + std::string(e.what()),
                      rover.files.front().string(), e.hint());
  }
}

std::optional<double> distance_by_code(const Base& b, const RtklibJob& job, double tolerance, core::Tally& tally) {
  core::GnssData fixes;
  try {
    fixes = alone(job, b.receiver);
  } catch (const core::SystemError&) {
    throw;
  } catch (const core::Error& e) {
    tally.count("base whose position could not be checked", b.name + ": " + e.what());
    return std::nullopt;
  }
  Eigen::Vector3d middle;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d& p : fixes.position) values.push_back(p[axis]);
    middle[axis] = core::median(std::move(values));
  }
  const double off = (middle - b.position).norm();
  if (off > tolerance)
    throw core::Error("the base '" + b.name + "' lies " + tenths(off) + " m from its stated position by its own code ranges",
                      b.receiver.files.front().string(),
                      "its position is that of the marker, ECEF metres; its code ranges say " + tenths(middle.x()) + " " +
                          tenths(middle.y()) + " " + tenths(middle.z()));
  return off;
}

core::GnssData solve(const Base& b, const RtklibJob& shared, core::Tally& tally) {
  RtklibJob job = shared;
  job.name = b.file_name;
  job.base = b.receiver.files;
  job.setup.base = b.position;
  job.setup.base_antenna = b.antenna;
  // The engine's folder is named by all inputs and options: a solution of a run that was stopped is this one's.
  const fs::path done = job.products / (job.name + ".pos");
  return read_pos(fs::exists(done) ? done : run_rtklib(job), {}, 0.0, tally);
}

}  // namespace swath::io
