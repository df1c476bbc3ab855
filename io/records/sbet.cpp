// SPDX-License-Identifier: GPL-3.0-or-later
// SBET: Applanix POSPac "smoothed best estimate of trajectory". What the fields mean was checked on real files: in the vendor's the
// velocity axes are north, west, up, turned by the wander angle (x axis at azimuth -wander); other programs write north, east, down.
// Neither is stated in the file, so the axes that agree with the positions are taken, or none.
#include "io/records/sbet.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/error.h"
#include "core/geo/frames.h"
#include "core/geo/geodesy.h"
#include "core/time.h"
#include "io/records/trajectory_faults.h"
#include "io/survey/wild_records.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

constexpr size_t sbet_chunk = 4096;
constexpr double arc_minute = core::degree / 60.0;

static_assert(sizeof(SbetRecord) == sbet_bytes && sizeof(SmrmsgRecord) == smrmsg_bytes);

struct Horizontal {
  double north, east;
};

/// Velocity over ground between two records, from their positions.
Horizontal ground_velocity(const core::TrajectoryData& t, size_t i, size_t j) {
  const double dt = t.time[j] - t.time[i], lat = 0.5 * (t.latitude[i] + t.latitude[j]), h = 0.5 * (t.height[i] + t.height[j]);
  return {(core::meridian_radius(lat) + h) * (t.latitude[j] - t.latitude[i]) / dt,
          (core::prime_vertical_radius(lat) + h) * std::cos(lat) * core::wrap_pi(t.longitude[j] - t.longitude[i]) / dt};
}

/// The stored velocities in north, east, down for a choice of axes.
void turned(VelocityAxes axes, const SbetRecord& r, double wander, double* ned) {
  const double c = std::cos(wander), s = std::sin(wander);
  const double right = axes == VelocityAxes::nwu ? -r.y_velocity : r.y_velocity;
  ned[0] = r.x_velocity * c + right * s;
  ned[1] = right * c - r.x_velocity * s;
  ned[2] = axes == VelocityAxes::nwu ? -r.z_velocity : r.z_velocity;
}

struct Velocities {
  std::vector<double> north, east, down;
};

/// Mean distance between the velocities and those of the positions over half a second, m/s, and the mean speed.
std::pair<double, double> disagreement(const core::TrajectoryData& t, const Velocities& v) {
  double sum = 0, speed = 0;
  size_t n = 0;
  for (size_t i = 0, j = 0; i < t.size(); i = j + 1) {
    j = i;
    while (j + 1 < t.size() && t.time[j] < t.time[i] + 0.5) ++j;
    if (!(t.time[j] > t.time[i]) || t.time[j] > t.time[i] + 2.0) continue;
    const Horizontal g = ground_velocity(t, i, j);
    double north = 0, east = 0, down = 0;
    for (size_t k = i; k <= j; ++k) {
      north += v.north[k];
      east += v.east[k];
      down += v.down[k];
    }
    const double m = static_cast<double>(j - i + 1), up = (t.height[j] - t.height[i]) / (t.time[j] - t.time[i]);
    sum += std::sqrt(std::pow(north / m - g.north, 2) + std::pow(east / m - g.east, 2) + std::pow(down / m + up, 2));
    speed += std::hypot(g.north, g.east);
    ++n;
  }
  return n ? std::pair{sum / static_cast<double>(n), speed / static_cast<double>(n)} : std::pair{0.0, 0.0};
}

void choose_velocities(core::TrajectoryData& t, VelocityAxes axes, const std::vector<VelocityAxes>& candidates, std::vector<Velocities>& v,
                       core::Tally& tally) {
  size_t best = 0;
  double least = std::numeric_limits<double>::infinity(), limit = 0;
  for (size_t i = 0; i < v.size(); ++i) {
    const auto [off, speed] = disagreement(t, v[i]);
    limit = 0.5 + 0.02 * speed;
    if (off < least) {
      least = off;
      best = i;
    }
  }
  if (axes == VelocityAxes::automatic && !(least <= limit)) {
    tally.count("SBET velocities that disagree with the positions, not used", "mean disagreement " + core::format_number(least, 3) + " m/s",
                t.size());
    return;
  }
  if (axes == VelocityAxes::automatic)
    tally.count(candidates[best] == VelocityAxes::nwu ? "SBET files with velocities north, west, up"
                                                      : "SBET files with velocities north, east, down");
  t.v_north = std::move(v[best].north);
  t.v_east = std::move(v[best].east);
  t.v_down = std::move(v[best].down);
}

void add_accuracy(core::TrajectoryData& t, const std::filesystem::path& path, const TimeTags& tags, core::Tally& tally) {
  const SmrmsgFile file(path);
  std::vector<SmrmsgRecord> rows;
  file.read(0, static_cast<size_t>(file.records()), rows);
  std::vector<double> times;
  for (const SmrmsgRecord& r : rows) times.push_back(r.time);
  times = gps_times(tags, path.string(), times, {}, "smrmsg records with an impossible time, left out", tally);
  const auto where = [&](size_t i) { return path.string() + ": record " + std::to_string(i); };
  std::vector<size_t> bad;
  size_t kept = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    SmrmsgRecord r = rows[i];
    r.time = times[i];
    if (std::isnan(r.time)) continue;
    bool good = true;
    for (size_t k = 0; k < 3; ++k) good = good && r.position[k] >= 0 && r.attitude[k] >= 0 && std::isfinite(r.position[k] + r.attitude[k]);
    if (!good) {
      bad.push_back(i);
      continue;
    }
    if (kept > 0 && r.time < rows[kept - 1].time) throw core::Error("time goes back", where(i), "sort the file by time");
    rows[kept++] = r;
  }
  if (!are_few(bad.size(), rows.size()))
    throw core::Error("a standard deviation is negative or not finite", where(bad[0]), "the file is damaged: export it again");
  for (const size_t i : bad) tally.count("smrmsg records with a sigma that is negative or not finite, left out", where(i));
  tally.read("smrmsg records", rows.size());
  tally.keep("smrmsg records", kept);
  rows.resize(kept);
  for (auto* c : {&t.sigma_north, &t.sigma_east, &t.sigma_down, &t.sigma_roll, &t.sigma_pitch, &t.sigma_heading}) c->resize(t.size());
  size_t at = 0;
  for (size_t i = 0; i < t.size(); ++i) {
    while (at + 1 < rows.size() && rows[at + 1].time <= t.time[i]) ++at;
    const SmrmsgRecord& a = rows[at];
    const SmrmsgRecord& b = rows[std::min(at + 1, rows.size() - 1)];
    if (t.time[i] < rows.front().time || t.time[i] > rows.back().time)
      tally.count("trajectory records outside the smrmsg's span (nearest sigma used)", "record " + std::to_string(i));
    const double f = b.time > a.time ? std::clamp((t.time[i] - a.time) / (b.time - a.time), 0.0, 1.0) : 0.0;
    const auto between = [f](double x, double y, double unit) { return static_cast<float>((x + f * (y - x)) * unit); };
    t.sigma_north[i] = between(a.position[0], b.position[0], 1);
    t.sigma_east[i] = between(a.position[1], b.position[1], 1);
    t.sigma_down[i] = between(a.position[2], b.position[2], 1);
    t.sigma_roll[i] = between(a.attitude[0], b.attitude[0], arc_minute);
    t.sigma_pitch[i] = between(a.attitude[1], b.attitude[1], arc_minute);
    t.sigma_heading[i] = between(a.attitude[2], b.attitude[2], arc_minute);
  }
}

/// Writes rows of doubles, little-endian.
class RowWriter {
 public:
  explicit RowWriter(const std::filesystem::path& file) : output_(file), out_(output_.temporary(), file) {}
  void row(std::initializer_list<double> values) {
    for (const double v : values) {
      unsigned char b[8];
      store(b, v);
      bytes_.insert(bytes_.end(), b, b + 8);
    }
    if (bytes_.size() > (1u << 20)) flush();
  }
  void commit() {
    flush();
    out_.close();
    output_.commit();
  }

 private:
  void flush() {
    out_.append(bytes_.data(), bytes_.size());
    bytes_.clear();
  }
  OutputFile output_;
  BinaryAppender out_;
  std::vector<unsigned char> bytes_;
};

}  // namespace

template <class Record>
RecordFile<Record>::RecordFile(const std::filesystem::path& file) : file_(file) {
  const bool sbet = sizeof(Record) == sbet_bytes;
  if (file_.size() == 0) throw core::Error("the file is empty", file.string(), "export it again");
  if (file_.size() % sizeof(Record) != 0)
    throw core::Error(std::to_string(file_.size()) + " bytes are no whole number of " +
                          (sbet ? "SBET records (136" : "smrmsg records (80") + " bytes); the last begins at byte " +
                          std::to_string(records() * sizeof(Record)),
                      file.string() + ": byte " + std::to_string(file_.size()), "the file is truncated or in another format");
}

template <class Record>
void RecordFile<Record>::read(std::uint64_t first, size_t n, std::vector<Record>& out) const {
  constexpr size_t fields = sizeof(Record) / sizeof(double);
  out.resize(n);
  std::vector<unsigned char> bytes(n * sizeof(Record));
  file_.read(first * sizeof(Record), bytes.data(), bytes.size());
  for (size_t i = 0; i < n; ++i) {
    std::array<double, fields> row;
    for (size_t f = 0; f < fields; ++f) row[f] = load<double>(bytes.data() + (i * fields + f) * sizeof(double));
    std::memcpy(&out[i], row.data(), sizeof(Record));
  }
}

template class RecordFile<SbetRecord>;
template class RecordFile<SmrmsgRecord>;

core::TrajectoryData read_sbet(const std::filesystem::path& path, const TimeTags& tags, bool wander, VelocityAxes axes,
                               const std::optional<std::filesystem::path>& accuracy, core::Tally& tally) {
  const SbetFile file(path);
  core::TrajectoryData out;
  std::vector<VelocityAxes> candidates;
  if (axes == VelocityAxes::automatic) candidates = {VelocityAxes::ned, VelocityAxes::nwu};
  if (axes == VelocityAxes::ned || axes == VelocityAxes::nwu) candidates = {axes};
  std::vector<Velocities> velocities(candidates.size());
  std::vector<SbetRecord> rows;
  std::vector<double> recorded;
  std::optional<core::Error> degrees;
  std::uint64_t no_radians = 0;
  const auto judge = [&](const SbetRecord& r, std::uint64_t number) {
    if (!(std::abs(r.latitude) > core::pi / 2 || std::abs(r.longitude) > 2 * core::pi)) return;
    if (no_radians++ == 0)
      degrees.emplace("latitude " + core::format_number(r.latitude) + ", longitude " + core::format_number(r.longitude) + " are no radians",
                      path.string() + ": record " + std::to_string(number),
                      "SBET angles are radians; is this an SBET, or one written in degrees?");
  };
  for (std::uint64_t first = 0; first < file.records(); first += sbet_chunk) {
    file.read(first, static_cast<size_t>(std::min<std::uint64_t>(sbet_chunk, file.records() - first)), rows);
    for (size_t i = 0; i < rows.size(); ++i) {
      const SbetRecord& r = rows[i];
      judge(r, first + i);
      const double turn = wander ? r.wander_angle : 0.0;
      recorded.push_back(r.time);
      out.latitude.push_back(r.latitude);
      out.longitude.push_back(r.longitude);
      out.height.push_back(r.altitude);
      out.roll.push_back(r.roll);
      out.pitch.push_back(r.pitch);
      out.heading.push_back(r.platform_heading - turn);
      for (size_t c = 0; c < candidates.size(); ++c) {
        double ned[3];
        turned(candidates[c], r, turn, ned);
        velocities[c].north.push_back(ned[0]);
        velocities[c].east.push_back(ned[1]);
        velocities[c].down.push_back(ned[2]);
      }
    }
  }
  if (degrees && !are_few(no_radians, file.records())) throw *degrees;
  tally.read("trajectory records", recorded.size());
  out.time = gps_times(tags, path.string(), recorded, {}, impossible_times, tally);
  if (const std::vector<std::uint8_t> marked = leave_out_faults(out, path.string(), tally); !marked.empty())
    for (Velocities& v : velocities)
      for (auto* c : {&v.north, &v.east, &v.down}) leave_out(*c, marked);
  for (size_t i = 0; i < out.size(); ++i) {
    out.longitude[i] = core::wrap_pi(out.longitude[i]);
    out.roll[i] = core::wrap_pi(out.roll[i]);
    out.heading[i] = core::wrap_two_pi(out.heading[i]);
  }
  if (!candidates.empty()) choose_velocities(out, axes, candidates, velocities, tally);
  if (accuracy) add_accuracy(out, *accuracy, tags, tally);
  return out;
}

void write_sbet(const std::filesystem::path& file, const core::TrajectoryData& t) {
  RowWriter out(file);
  const double week = t.size() ? core::week_of(t.time[0]) * core::seconds_per_week : 0.0;
  for (size_t i = 0; i < t.size(); ++i) {
    double north = 0, east = 0, down = 0;
    if (t.has_velocity()) {
      north = t.v_north[i];
      east = t.v_east[i];
      down = t.v_down[i];
    } else if (t.size() > 1) {
      const size_t a = i > 0 ? i - 1 : i, b = i + 1 < t.size() ? i + 1 : i;
      const Horizontal g = ground_velocity(t, a, b);
      north = g.north;
      east = g.east;
      down = -(t.height[b] - t.height[a]) / (t.time[b] - t.time[a]);
    }
    out.row({t.time[i] - week, t.latitude[i], t.longitude[i], t.height[i], north, -east, -down, t.roll[i], t.pitch[i],
             core::wrap_pi(t.heading[i]), 0, 0, 0, 0, 0, 0, 0});
  }
  out.commit();
}

void write_smrmsg(const std::filesystem::path& file, const core::TrajectoryData& t) {
  if (!t.has_sigma()) throw core::Error("the trajectory has no sigmas to write", file.string());
  RowWriter out(file);
  const double week = t.size() ? core::week_of(t.time[0]) * core::seconds_per_week : 0.0;
  for (size_t i = 0; i < t.size(); ++i) {
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    if (!t.covariance.empty()) velocity = t.covariance.at(t.time[i]).diagonal().segment<3>(3).cwiseSqrt();
    out.row({t.time[i] - week, t.sigma_north[i], t.sigma_east[i], t.sigma_down[i], velocity[0], velocity[1], velocity[2],
             t.sigma_roll[i] / arc_minute, t.sigma_pitch[i] / arc_minute, t.sigma_heading[i] / arc_minute});
  }
  out.commit();
}

}  // namespace swath::io
