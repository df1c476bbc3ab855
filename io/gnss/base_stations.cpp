// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gnss/base_stations.h"

#include <algorithm>
#include <cctype>
#include <set>

#include "core/error.h"
#include "core/time.h"
#include "io/gnss/antex.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

std::string kilometres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f km", metres / 1000);
  return text;
}

std::string span_text(const Receiver& r) { return core::utc_text(r.first) + " to " + core::utc_text(r.last); }

/// A name that is a file's name everywhere, unlike those in `used`.
std::string as_file_name(std::string name, std::set<std::string>& used) {
  for (char& c : name)
    if (!(std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_')) c = '_';
  std::string out = name;
  for (int i = 2; !used.insert(out).second; ++i) out = name + "_" + std::to_string(i);
  return out;
}

}  // namespace

Receiver scan_receiver(const Survey& survey, const std::vector<fs::path>& files) {
  Receiver r;
  for (const fs::path& name : files) {
    r.files.push_back(resolve(survey, name));
    const RinexObservations o = scan_rinex(r.files.back());
    if (r.epochs == 0) r.header = o.header;
    if (!r.header.position) r.header.position = o.header.position;
    if (r.header.antenna_type.empty()) r.header.antenna_type = o.header.antenna_type;
    r.first = std::min(r.first, o.first);
    r.last = std::max(r.last, o.last);
    r.interval = std::max(r.interval, o.interval);
    r.epochs += o.epochs;
  }
  return r;
}

std::string antenna_type(const std::optional<fs::path>& antenna_file, const std::string& stated, const Receiver& receiver,
                         const std::string& whose) {
  if (stated.empty()) return {};
  const std::string type = stated == "*" ? receiver.header.antenna_type : stated;
  if (type.empty())
    throw core::Error("the RINEX header names no antenna type for " + whose, receiver.files.front().string(), "state antenna_type");
  return find_antenna(antex_types(*antenna_file), type, *antenna_file);
}

std::vector<Base> read_bases(const Survey& survey, const Receiver& rover, const Eigen::Vector3d& place, core::Tally& tally) {
  std::vector<Base> out;
  std::set<std::string> used = {"combined"};
  const Rinex& r = survey.rinex;
  std::optional<fs::path> antenna_file;
  if (r.antenna_file) antenna_file = resolve(survey, *r.antenna_file);
  for (const BaseStation& stated : r.bases) {
    Base b;
    b.receiver = scan_receiver(survey, stated.observations);
    const RinexHeader& header = b.receiver.header;
    b.name = !stated.name.empty() ? stated.name : !header.marker.empty() ? header.marker : "base " + std::to_string(out.size() + 1);
    b.file_name = as_file_name(b.name, used);
    if (stated.position) {
      for (size_t k = 0; k < 3; ++k) b.position[static_cast<int>(k)] = (*stated.position)[k].value;
    } else if (header.position) {
      b.position = *header.position;
      tally.count("base at the approximate position of its RINEX header: all fixes are wrong by what it is wrong", b.name);
    } else {
      throw core::Error("the base '" + b.name + "' has no position", b.receiver.files.front().string(),
                        "state its marker's position in [[rinex.base]]: position = [\"x m\", \"y m\", \"z m\"] (ECEF)");
    }
    if (stated.antenna_offset)
      for (size_t k = 0; k < 3; ++k) b.antenna.offset[static_cast<int>(k)] = (*stated.antenna_offset)[k].value;
    else
      b.antenna.offset = header.antenna_offset;
    b.antenna.type = antenna_type(antenna_file, stated.antenna_type, b.receiver, "the base '" + b.name + "'");
    if (r.antenna_file && b.antenna.type.empty()) tally.count("antenna without a type: its phase centre is not applied", b.name);
    b.distance = (b.position - place).norm();
    b.overlap = std::min(b.receiver.last, rover.last) - std::max(b.receiver.first, rover.first);
    out.push_back(std::move(b));
  }
  std::stable_sort(out.begin(), out.end(), [](const Base& a, const Base& b) { return a.distance < b.distance; });
  return out;
}

std::vector<std::string> reasons_against(const std::vector<Base>& bases, const Receiver& rover, double farthest, size_t most) {
  std::vector<std::string> out;
  std::string distances, spans;
  size_t reached = 0, chosen = 0;
  for (const Base& b : bases) {
    std::string& reason = out.emplace_back();
    if (b.distance > farthest) {
      reason = "farther than max_distance";
      distances += (distances.empty() ? "" : ", ") + b.name + " " + kilometres(b.distance);
      continue;
    }
    ++reached;
    const bool one_epoch = rover.last == rover.first;
    if (one_epoch ? b.overlap < 0 : b.overlap <= 0) {
      reason = "records at other times than the rover";
      spans += (spans.empty() ? "" : "; ") + b.name + " " + span_text(b.receiver);
    } else if (chosen >= most) {
      reason = "nearer ones are enough";
    } else {
      ++chosen;
    }
  }
  if (reached == 0)
    throw core::Error("no base station within " + kilometres(farthest) + " of the rover: " + distances, rover.files.front().string(),
                      "is the base's position in ECEF metres? take a nearer base, or raise max_distance (fixes grow worse)");
  if (chosen == 0)
    throw core::Error("no base station records while the rover does (" + span_text(rover) + "): " + spans, rover.files.front().string(),
                      "name the base's observations of the flight");
  return out;
}

}  // namespace swath::io
