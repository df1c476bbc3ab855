// SPDX-License-Identifier: GPL-3.0-or-later
#include "trajectory/event_table.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/error.h"
#include "core/printable.h"
#include "core/statistics.h"

namespace swath::trajectory {
namespace {

std::string number(double v, int decimals) {
  if (!std::isfinite(v)) return {};
  char text[40];
  std::snprintf(text, sizeof text, "%.*f", decimals, v);
  return text;
}
std::string numbers(const Eigen::Vector3d& v, int decimals) {
  return number(v[0], decimals) + "," + number(v[1], decimals) + "," + number(v[2], decimals);
}

std::string flags_of(const EventPosition& e, bool doubtful) {
  std::string out;
  const auto add = [&](const char* flag) { out += (out.empty() ? "" : ";") + std::string(flag); };
  if (e.reach == Reach::outside) add("outside_gnss");
  if (e.reach == Reach::gap) add("gnss_gap");
  if (e.reach == Reach::too_few) add("too_few_fixes");
  if (e.reach == Reach::partial) add("short_window");
  if (doubtful) add("doubtful_time");
  return out;
}

constexpr const char* gnss_record = "the GNSS record";
constexpr const char* header =
    "id,strip,technique,gps_time,easting,northing,height,x,y,z,v_east,v_north,v_up,sigma_east,sigma_north,sigma_up,"
    "sigma_v_east,sigma_v_north,sigma_v_up,sigma_time,fixes,flags\n";

}  // namespace

core::GnssData usable_fixes(const core::GnssData& gnss, core::Tally& tally) {
  core::GnssData out;
  for (size_t i = 0; i < gnss.size(); ++i) {
    if (!usable(gnss, i)) {
      tally.count("GNSS fixes without a position or a covariance, left out", "fix " + std::to_string(i + 1));
      continue;
    }
    out.time.push_back(gnss.time[i]);
    out.position.push_back(gnss.position[i]);
    out.covariance.push_back(gnss.covariance[i]);
  }
  return out;
}

std::string table_of(const core::EventData& events, const std::vector<EventPosition>& solved, const core::Crs& crs, double vertical_unit) {
  const core::Transform to_map(core::wgs84_ecef(), crs);
  const double height_unit = crs.has_height_unit() ? 1.0 : vertical_unit;
  const int decimals = crs.is_geographic() ? 10 : 4;
  std::string out = header;
  for (size_t i = 0; i < events.size(); ++i) {
    const EventPosition& e = solved[i];
    Eigen::Vector3d map = e.position;
    if (reached(e.reach)) {
      map = to_map(e.position);
      map.z() /= height_unit;
    }
    // What the time's own error moves the antenna along its path.
    const double along = events.sigma[i] > 0.0 ? events.sigma[i] * e.velocity.norm() : std::nan("");
    out += core::csv_field(events.id[i]) + "," + (events.strip[i] ? std::to_string(events.strip[i]) : "") + "," +
           core::csv_field(events.technique[i]) + "," + number(events.time[i], 7) + "," + number(map.x(), decimals) + "," +
           number(map.y(), decimals) + "," + number(map.z(), 4) + "," + numbers(e.position, 4) + "," + numbers(e.velocity, 4) + "," +
           numbers(e.sigma, 4) + "," + numbers(e.velocity_sigma, 4) + "," + number(along, 4) + "," + std::to_string(e.fixes) + "," +
           flags_of(e, events.doubtful[i]) + "\n";
  }
  return out;
}

void count_events(const core::EventData& events, const core::GnssData& gnss, const std::vector<EventPosition>& solved,
                  const std::string& survey, core::Tally& tally) {
  size_t outside = 0;
  for (size_t i = 0; i < events.size(); ++i) {
    const std::string event = "event " + events.id[i];
    switch (solved[i].reach) {
      case Reach::full:
        break;
      case Reach::partial:
        tally.count("events near a gap or an end of the GNSS record: short window", event);
        break;
      case Reach::too_few:
        tally.count("events too close to a gap or an end of the GNSS record, without position", event);
        break;
      case Reach::gap:
        tally.count("events in a gap of the GNSS record, without position", event);
        break;
      case Reach::outside:
        tally.count("events outside the GNSS record, without position", event);
        ++outside;
        break;
    }
    if (events.doubtful[i]) tally.count("events whose time is doubtful", event);
  }
  if (events.size() > 0 && outside == events.size())
    if (const auto found = outside_of("", events.time, {gnss.time.front(), gnss.time.back()}, gnss_record))
      throw core::Error("trajectory.kinematic: " + found->what, survey, found->cause);
}

MotionFigures figures_of(const MotionModel& model) {
  MotionFigures r{model.motion.size(), model.white};
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = static_cast<size_t>(axis);
    std::vector<double> levels;
    for (const PointMotion& m : model.motion) levels.push_back(m[k].acceleration());
    r.acceleration[axis] = core::median(std::move(levels));
    r.time[axis] = model.motion.front()[k].time;
  }
  return r;
}

EventFigures figures_of(const core::EventData& events, const PointTrack& track, const std::vector<EventPosition>& solved,
                        Interpolator method) {
  EventFigures r;
  r.method = core::Choices<Interpolator>::names[static_cast<size_t>(method)];
  r.fixes = track.fixes.size();
  for (size_t i = 1; i < track.fixes.size(); ++i) r.gaps += track.fixes.time[i] - track.fixes.time[i - 1] > track.longest_step;
  r.longest_step = track.longest_step;
  r.events = events.size();
  r.motion = figures_of(track.model());
  r.comparisons = compare_event_places(events, solved);
  r.outside = outside_of(events, {track.fixes.time.front(), track.fixes.time.back()}, gnss_record);
  std::array<std::vector<double>, 3> sigmas;
  for (const EventPosition& e : solved)
    for (int axis = 0; axis < 3 && reached(e.reach); ++axis) sigmas[static_cast<size_t>(axis)].push_back(e.sigma[axis]);
  r.with_position = sigmas[0].size();
  if (r.with_position > 0) r.sigma = Eigen::Vector3d(core::median(sigmas[0]), core::median(sigmas[1]), core::median(sigmas[2]));
  return r;
}

}  // namespace swath::trajectory
