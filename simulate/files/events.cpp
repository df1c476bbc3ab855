// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/events.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/config/units.h"
#include "io/text/output_file.h"
#include "io/text/text_rows.h"
#include "simulate/files/computer_clock.h"
#include "simulate/files/laser_file.h"
#include "simulate/random.h"

namespace swath::simulate {
namespace {

constexpr double day = 86400.0;
constexpr std::int64_t gps_epoch_mjd = 44244;  // 1980-01-06

template <class... Values>
void put_line(std::string& to, const char* form, Values... values) {
  std::array<char, 200> line;
  to.append(line.data(), static_cast<size_t>(std::snprintf(line.data(), line.size(), form, values...)));
}

/// ntpd's own columns and decimals.
std::string loopstats(const ComputerClock& clock, core::GpsTime start, int poll) {
  std::string out;
  for (const ComputerClock::Update& u : clock.updates()) {
    const UtcDay at = utc_day(start, u.t, u.clock);
    put_line(out, "%lld %.3f %.9f %.3f %.9f %.6f %d\n", static_cast<long long>(at.mjd), at.second, u.offset, 1e6 * u.frequency, u.jitter,
             1e6 * u.wander, poll);
  }
  return out;
}

std::string pulses(const ComputerClock& clock, core::GpsTime start, double duration, double noise, std::int64_t seed) {
  std::string out;
  const double first = clock.updates().front().t, second = utc_day(start, first).second;
  const double pulse = first + std::ceil(second) - second;
  std::uint64_t k = 0;
  for (double t = pulse; t <= duration; t = pulse + static_cast<double>(++k)) {
    Random random = random_of(seed, Stream::clock, 1 + k);
    const UtcDay at = utc_day(start, t, clock.offset(t) + noise * random.normal());
    put_line(out, "%lld %.9f\n", static_cast<long long>(at.mjd), at.second);
  }
  return out;
}

}  // namespace

std::vector<Event> plan_events(const Flight& flight, const EventOptions& options, std::int64_t seed) {
  std::vector<Event> out;
  const double interval = options.interval.value;
  for (const Line& line : flight.lines()) {
    Random random = random_of(seed, Stream::events, static_cast<std::uint64_t>(line.id));
    for (double t = line.start + interval * random.uniform(0.1, 0.9); t < line.end - 0.05 * interval; t += interval)
      out.push_back({static_cast<int>(out.size()) + 1, line.id, t + interval * random.uniform(-0.02, 0.02)});
  }
  return out;
}

UtcDay utc_day(core::GpsTime start, double t, double offset) {
  const int week = core::week_of(start);
  // Within a day of the week's start, where a second still has 1e-10 s behind its point.
  const double second = (start - core::seconds_per_week * week) - core::gps_minus_utc_at_gps(start + t) + t + offset;
  const double days = std::floor(second / day);
  return {gps_epoch_mjd + 7 * static_cast<std::int64_t>(week) + static_cast<std::int64_t>(days), second - day * days};
}

std::int64_t write_events(const std::filesystem::path& folder, const Flight& flight, core::GpsTime start, const EventOptions& options,
                          bool noise_free, std::int64_t seed) {
  ClockOptions clock_options = options.clock;
  if (noise_free) clock_options.jitter.value = clock_options.wander.value = 0.0;
  const double tag_noise = noise_free ? 0.0 : options.tag_noise.value, mark_noise = noise_free ? 0.0 : options.mark_noise.value;
  const ComputerClock clock(clock_options, flight.duration(), seed);
  io::TextRows pc(folder / "events_pc.csv", "id,strip,pc_utc_s\n");
  io::TextRows marks(folder / "events_marks.csv", "id,strip,gps_sow_s\n");
  io::TextRows truth(folder / "truth" / "events.csv",
                     "id,strip,gps_sow_s,pc_minus_utc_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,heading_deg\n");
  const double sow = start - core::seconds_per_week * core::week_of(start);
  const std::vector<Event> events = plan_events(flight, options, seed);
  for (const Event& e : events) {
    Random random = random_of(seed, Stream::events, (std::uint64_t{1} << 32) + static_cast<std::uint64_t>(e.id));
    const double offset = clock.offset(e.t);
    for (io::TextRows* rows : {&pc, &marks, &truth}) {
      rows->number(e.id, 0);
      rows->number(e.line, 0);
    }
    pc.number(utc_day(start, e.t, offset + tag_noise * random.normal()).second, 9);
    marks.number(sow + e.t + mark_noise * random.normal(), 9);
    truth.number(sow + e.t, 9);
    truth.number(offset, 9);
    const Pose pose = flight.pose(e.t);
    truth.number(pose.position.latitude / core::degree, 12);
    truth.number(pose.position.longitude / core::degree, 12);
    truth.number(pose.position.height, 6);
    for (const double a : {pose.attitude.roll, pose.attitude.pitch, pose.attitude.heading}) truth.number(a / core::degree, 9);
    for (io::TextRows* rows : {&pc, &marks, &truth}) rows->end();
  }
  for (io::TextRows* rows : {&pc, &marks, &truth}) rows->commit();
  io::write_text_file(folder / "loopstats", loopstats(clock, start, options.clock.poll));
  io::write_text_file(folder / "pps.log", pulses(clock, start, flight.duration(), tag_noise, seed));
  return static_cast<std::int64_t>(events.size());
}

std::vector<io::ClockLog> describe_clocks() { return {{"loopstats", io::ClockFormat::loopstats}}; }

std::vector<io::EventFile> describe_events(const Flight& flight, core::GpsTime start, const EventOptions& options, std::int64_t seed) {
  const std::vector<Event> events = plan_events(flight, options, seed);
  const core::GpsTime first = start + (events.empty() ? 0.0 : events.front().t);
  io::EventFile pc, marks;
  pc.file = "events_pc.csv";
  pc.technique = "pc";
  pc.time = tags_of(core::TimeScale::utc_day, first);
  pc.computer_clock = true;
  pc.columns = {"pc_utc_s", "id", "strip"};
  marks.file = "events_marks.csv";
  marks.technique = "marks";
  marks.time = tags_of(core::TimeScale::gps_week, start);
  marks.columns = {"gps_sow_s", "id", "strip"};
  return {pc, marks};
}

}  // namespace swath::simulate
