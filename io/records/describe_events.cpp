// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/records/describe_events.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "core/config/interval.h"
#include "core/config/result_visitors.h"
#include "core/error.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/records/clock_log.h"
#include "io/records/event_marks.h"
#include "io/records/repeated_times.h"
#include "io/survey/hangar_file.h"
#include "io/text/line_reader.h"

namespace swath::io {
namespace {

/// What a reader has counted, as texts.
void add_counts(const core::Tally& tally, std::vector<std::string>& warnings) {
  const core::Value counted = tally.value();
  for (const auto& [what, entry] : counted.members()) {
    std::string text = what + ": " + std::to_string(entry.find("count")->as_int());
    if (const core::Value* examples = entry.find("examples")) text += " (" + examples->items()[0].as_text() + ")";
    warnings.push_back(std::move(text));
  }
}

struct EventFacts {
  std::string format;
  std::vector<EventMark> marks{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const EventFacts& r, V& v) {
  std::vector<double> steps, sigmas;
  std::uint64_t doubtful = 0, places = 0;
  for (size_t i = 0; i < r.marks.size(); ++i) {
    const EventMark& m = r.marks[i];
    if (i > 0) steps.push_back(m.second - r.marks[i - 1].second + (m.fraction - r.marks[i - 1].fraction));
    if (m.sigma > 0) sigmas.push_back(m.sigma);
    doubtful += m.doubtful;
    places += m.place.allFinite();
  }
  const auto any = core::plain().only_if(!r.marks.empty());
  const auto utc = [](const EventMark& m) { return core::utc_text(m.second + m.fraction); };
  v.result("format", r.format, "Format.");
  v.result("events", r.marks.size(), "Events.");
  v.result("first", r.marks.empty() ? std::string() : utc(r.marks.front()), any, "UTC of the first.");
  v.result("last", r.marks.empty() ? std::string() : utc(r.marks.back()), any, "UTC of the last.");
  v.result("median_interval_s", core::median(steps, 0.0), core::seconds().only_if(!steps.empty()), "Usual time between two.");
  v.result("median_sigma_s", core::median(sigmas, 0.0), core::Form{"s"}.only_if(!sigmas.empty()), "Median of the stated sigmas of time.");
  v.result("with_place", places, core::if_any(), "Events whose place the recorder states.");
  v.result("doubtful", doubtful, core::if_any(), "Events whose recorder had no fix of GPS time.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

/// Events of one time, with their names; times count from the first event, where a double holds their last digit.
void count_repeated(const std::vector<EventMark>& marks, core::Tally& tally) {
  std::vector<double> time;
  for (const EventMark& m : marks) time.push_back(m.second - marks.front().second + m.fraction);
  for (const auto& [first, again] : repeated_times(time))
    tally.count("events at the time of another one", marks[first].id + " and " + marks[again].id);
}

struct LoopFacts {
  std::optional<core::ClockData> log{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const LoopFacts& r, V& v) {
  core::Interval offset, jitter;
  const size_t n = r.log ? r.log->size() : 0;
  for (size_t i = 0; i < n; ++i) offset.add(r.log->offset[i]);
  for (size_t i = 0; r.log && i < r.log->jitter.size(); ++i) jitter.add(r.log->jitter[i]);
  const auto utc = [&](size_t i) { return n > 0 ? core::utc_text(r.log->epoch + r.log->time[i]) : std::string(); };
  const auto any = core::plain().only_if(n > 0);
  v.result("format", std::string("loopstats"), "Format.");
  v.result("records", n, "Records.");
  v.result("first", utc(0), any, "UTC of the first, by the clock.");
  v.result("last", utc(n > 0 ? n - 1 : 0), any, "UTC of the last.");
  v.result("seconds", n > 0 ? r.log->time.back() - r.log->time.front() : 0.0, core::seconds().only_if(n > 0),
           "Time from the first to the last.");
  v.result("offset_s", offset, "Smallest and largest offset, UTC less clock.");
  v.result("jitter_s", jitter, "Smallest and largest jitter.");
  v.result("warnings", r.warnings, "What looks wrong.");
}

struct HangarFacts {
  std::optional<HangarSurvey> survey{};
  std::vector<std::string> warnings{};
};
template <class V>
void describe(const HangarFacts& r, V& v) {
  const auto any = core::plain().only_if(r.survey.has_value());
  const HangarSurvey none, &s = r.survey ? *r.survey : none;
  std::vector<std::string> points;
  for (const HangarPoint& p : s.points) points.push_back(p.name);
  v.result("format", std::string("hangar survey"), "Format.");
  v.result("targets", s.targets.size(), any, "Targets that define the frame.");
  v.result("stations", s.stations.size(), any, "Stations of the instrument.");
  v.result("points", points, any, "Points of the aircraft.");
  v.result("distances", s.distances.size(), any, "Distances.");
  v.result("angles", s.angles.size(), any, "Horizontal angles.");
  v.result("vertical_angles", s.verticals.size(), any, "Vertical angles.");
  v.result("warnings", r.warnings, "What makes it unreadable.");
}

}  // namespace

core::Value describe_events(const std::filesystem::path& path, EventFormat format) {
  EventFile file;
  EventFacts out;
  out.format = format == EventFormat::ubx       ? "UBX (u-blox)"
               : format == EventFormat::mrk     ? "Timestamp.MRK (DJI)"
               : format == EventFormat::novatel ? "MARKTIME (NovAtel)"
                                                : "RINEX";
  core::Tally tally;
  try {
    out.marks = read_marks(path, file, format, tally);
    count_repeated(out.marks, tally);
  } catch (const core::Error& e) {
    out.warnings.push_back(e.text());
  }
  add_counts(tally, out.warnings);
  return core::reported(out);
}

bool looks_like_loopstats(const std::filesystem::path& file) {
  LineReader lines(file);
  int taken = 0;
  for (std::string_view line; taken < 3 && lines.next(line);) {
    if (line.empty() || line.front() == '#' || line.front() == '%') continue;
    const auto words = words_of(line);
    double value[7];
    if (words.size() != 7) return false;
    for (size_t k = 0; k < 7; ++k)
      if (!read_number(words[k], value[k])) return false;
    const bool plausible = value[0] == std::floor(value[0]) && value[0] > 40000 && value[0] < 90000 && value[1] >= 0 && value[1] <= 86401 &&
                           std::abs(value[2]) < 1e4 && value[4] >= 0 && value[5] >= 0 && value[6] == std::floor(value[6]) &&
                           value[6] >= 0 && value[6] <= 20;
    if (!plausible) return false;
    ++taken;
  }
  return taken > 0;
}

core::Value describe_loopstats(const std::filesystem::path& file) {
  LoopFacts out;
  core::Tally tally;
  try {
    out.log = read_clock_log(file, ClockFormat::loopstats, tally);
  } catch (const core::Error& e) {
    out.warnings.push_back(e.text());
  }
  add_counts(tally, out.warnings);
  return core::reported(out);
}

core::Value describe_hangar(const std::filesystem::path& file) {
  HangarFacts out;
  try {
    out.survey = read_hangar(file);
  } catch (const core::Error& e) {
    out.warnings.push_back(e.text());
  }
  return core::reported(out);
}

}  // namespace swath::io
