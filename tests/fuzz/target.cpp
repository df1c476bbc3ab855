// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/fuzz/target.h"

#include <fcntl.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "core/config/option_visitors.h"
#include "core/config/units.h"
#include "core/error.h"
#include "io/records/laser_file.h"
#include "io/text/value_file.h"

namespace swath::fuzz {
namespace {

constexpr double farthest_time = 1e11;  // s: three thousand years

struct Folder {
  std::filesystem::path path = "/dev/shm/swath-fuzz-" + std::to_string(getpid());
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
};

}  // namespace

const std::filesystem::path& folder() {
  static const Folder one;
  return one.path;
}

std::filesystem::path given(const std::string& name, const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path file = folder() / name;
  const int fd = open(file.c_str(), O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0600);
  const bool written = fd >= 0 && write(fd, data, size) == static_cast<ssize_t>(size);
  if (fd >= 0) close(fd);
  if (!written) {
    std::fprintf(stderr, "no room for the input in %s\n", file.c_str());
    std::exit(2);
  }
  return file;
}

void reading(const std::function<void()>& reader) {
  try {
    reader();
  } catch (const core::Error&) {
  }
}

void expect(double value, double most, const char* what) {
  if (std::abs(value) <= most) return;
  std::fprintf(stderr, "finding: %s is %g, and was accepted\n", what, value);
  std::abort();
}

io::Survey survey_of(const std::string& tables) {
  io::Survey survey;
  std::vector<core::Fault> faults;
  core::read_options(core::described(survey), io::parse_toml("crs = \"EPSG:32632\"\n" + tables, "survey"), "", faults);
  if (!faults.empty()) {
    std::fprintf(stderr, "the target's own survey: %s\n", faults.front().what.c_str());
    std::exit(2);
  }
  survey.folder = folder();
  return survey;
}

void expect_sound(const core::TrajectoryData& t) {
  for (std::size_t i = 0; i < t.size(); ++i) {
    expect(t.time[i], farthest_time, "a time");
    if (i > 0 && !(t.time[i] > t.time[i - 1])) expect(NAN, 0, "the step between two times");
    expect(t.latitude[i], 0.5 * core::pi, "a latitude");
    expect(t.longitude[i], 2 * core::pi, "a longitude");
    expect(t.height[i], 1e6, "a height");
    expect(t.roll[i], 1e3, "a roll");
    expect(t.pitch[i], 1e3, "a pitch");
    expect(t.heading[i], 1e3, "a heading");
  }
}

void expect_sound(const core::GnssData& g) {
  for (std::size_t i = 0; i < g.size(); ++i) {
    expect(g.time[i], farthest_time, "a time");
    expect(g.position[i].norm(), 6.6e6, "the distance of a fix from the Earth's centre");
    expect(g.covariance[i].norm(), 1e30, "a covariance");
  }
}

void expect_sound(const core::ImuData& d) {
  for (std::size_t i = 0; i < d.size(); ++i) {
    expect(d.time[i], farthest_time, "a time");
    expect(d.angle[i].norm(), 1e300, "an increment of angle");
    expect(d.velocity[i].norm(), 1e300, "an increment of velocity");
  }
}

void read_shots(const io::Survey& survey) {
  constexpr double longest_range = 1e5;  // m
  core::Tally tally;
  std::size_t seen = 0;
  for (const io::StripInfo& strip : io::scan(survey, tally)) {
    io::LaserSource source(survey, strip);
    core::Shots batch;
    while (seen < most_values && source.next(batch, 1000)) {
      seen += batch.size();
      for (std::size_t i = 0; i < batch.size(); ++i) {
        expect(batch.time[i], farthest_time, "a time");
        expect(batch.range[i], longest_range, "a range");
        expect(batch.angle[i], 2 * core::pi, "an angle");
      }
    }
  }
}

}  // namespace swath::fuzz
