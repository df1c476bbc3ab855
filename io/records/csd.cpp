// SPDX-License-Identifier: GPL-3.0-or-later
// The layout (public: the structures of PDAL's Optech reader): a header of 2048 bytes, packed, little-endian: signature "CSD\0",
// vendor 64, software 32, version f32, header size u16, GPS week u16, first and last time f64, records u32, strips u16, 256 strip
// pointers u32, misalignment 3 f64, IMU offsets 3 f64, temperature f64, pressure f64, free space. Then pulses of 69 bytes.
// The strip pointers' unit is stated nowhere; they are not used.
#include "io/records/csd.h"

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/time.h"

namespace swath::io {
namespace {

constexpr size_t header_bytes = 2048;
constexpr size_t pulse_bytes = 69;
constexpr size_t csd_chunk = 8192;

std::string text_at(const unsigned char* at, size_t n) {
  size_t length = 0;
  while (length < n && at[length] >= 32 && at[length] < 127) ++length;
  return {reinterpret_cast<const char*>(at), length};
}

CsdHeader header_from(const unsigned char* b) {
  CsdHeader h;
  h.vendor = text_at(b + 4, 64);
  h.software = text_at(b + 68, 32);
  h.format_version = load<float>(b + 100);
  h.gps_week = load<std::uint16_t>(b + 106);
  h.first_time = load<double>(b + 108);
  h.last_time = load<double>(b + 116);
  h.records = load<std::uint32_t>(b + 124);
  h.strips = load<std::uint16_t>(b + 128);
  for (size_t i = 0; i < 3; ++i) {
    h.misalignment[i] = load<double>(b + 1154 + 8 * i);
    h.imu_offset[i] = load<double>(b + 1178 + 8 * i);
  }
  h.temperature = load<double>(b + 1202);
  h.pressure = load<double>(b + 1210);
  return h;
}

CsdPulse pulse_from(const unsigned char* b) {
  CsdPulse p;
  p.time = load<double>(b);
  p.return_count = b[8];
  for (size_t i = 0; i < 4; ++i) {
    p.range[i] = load<float>(b + 9 + 4 * i);
    p.intensity[i] = load<std::uint16_t>(b + 25 + 2 * i);
  }
  p.scan_angle = load<float>(b + 33);
  p.roll = load<float>(b + 37);
  p.pitch = load<float>(b + 41);
  p.heading = load<float>(b + 45);
  p.latitude = load<double>(b + 49);
  p.longitude = std::remainder(load<double>(b + 57), 2 * std::numbers::pi);
  p.height = load<float>(b + 65);
  return p;
}

}  // namespace

core::Calibration calibration_of(const CsdHeader& h) {
  core::Calibration c;
  c.roll.value = h.misalignment[0] + h.imu_offset[0];
  c.pitch.value = h.misalignment[1] + h.imu_offset[1];
  c.heading.value = h.misalignment[2] + h.imu_offset[2];
  return c;
}

CsdReader::CsdReader(const std::filesystem::path& file) : file_(file) {
  std::vector<unsigned char> b(header_bytes);
  if (file_.read_some(0, b.data(), 4) < 4 || std::string(b.begin(), b.begin() + 4) != std::string("CSD\0", 4))
    throw core::Error("is no Optech CSD file: it does not begin with CSD", file.string() + ": byte 0",
                      "check the name, or state the format");
  file_.read(0, b.data(), header_bytes);
  if (const int stated = load<std::uint16_t>(b.data() + 104); stated != header_bytes)
    throw core::Error("the header states a size of " + std::to_string(stated) + " bytes; 2048 is known", file.string() + ": byte 104",
                      "the file is damaged or of another version");
  header_ = header_from(b.data());
  const std::uint64_t body = file_.size() - header_bytes;
  pulses_ = body / pulse_bytes;
  if (body % pulse_bytes != 0 || pulses_ < header_.records)
    throw core::Error("the file ends early: the header states " + std::to_string(header_.records) + " pulses, " + std::to_string(pulses_) +
                          " are there" + (body % pulse_bytes ? " and a part of one" : ""),
                      file.string() + ": byte " + std::to_string(file_.size()), "the file is truncated: copy or export it again");
  if (pulses_ != header_.records)
    throw core::Error("the header states " + std::to_string(header_.records) + " pulses, the file holds " + std::to_string(pulses_),
                      file.string() + ": byte 124", "its writer was stopped before the end: export it again");
}

void CsdReader::read(std::uint64_t first, size_t n, std::vector<CsdPulse>& pulses) {
  bytes_.resize(n * pulse_bytes);
  file_.read(header_bytes + first * pulse_bytes, bytes_.data(), bytes_.size());
  pulses.resize(n);
  for (size_t i = 0; i < n; ++i) {
    pulses[i] = pulse_from(bytes_.data() + i * pulse_bytes);
    if (pulses[i].return_count > 4)
      throw core::Error("a pulse states " + std::to_string(pulses[i].return_count) + " returns; at most 4 are held",
                        file_.path().string() + ": record " + std::to_string(first + i), "the file is damaged: export it again");
  }
}

void hold_csd_week(const std::filesystem::path& file, int week) {
  const int stated = CsdReader(file).header().gps_week;
  constexpr int roll_over = 1024;
  if (stated == week || (stated < roll_over && stated == week % roll_over)) return;
  throw core::usage_error("the survey states GPS week " + std::to_string(week) + ", the file's header " + std::to_string(stated),
                          file.string(), "leave the week out to use the header's, or correct it; `swath info` shows the header");
}

core::TrajectoryData read_csd_trajectory(CsdReader& file, core::Seconds spacing, core::Tally& tally) {
  core::TrajectoryData out;
  std::vector<CsdPulse> pulses;
  double last = -std::numeric_limits<double>::infinity();
  for (std::uint64_t first = 0; first < file.pulses(); first += csd_chunk) {
    const size_t n = static_cast<size_t>(std::min<std::uint64_t>(csd_chunk, file.pulses() - first));
    file.read(first, n, pulses);
    for (size_t i = 0; i < n; ++i) {
      const CsdPulse& p = pulses[i];
      const std::string record = "record " + std::to_string(first + i);
      if (!std::isfinite(p.time) || !std::isfinite(p.roll) || !std::isfinite(p.pitch) || !std::isfinite(p.heading) ||
          !std::isfinite(p.latitude) || !std::isfinite(p.longitude) || !std::isfinite(p.height)) {
        throw core::Error("a value of the pose is not finite", file.path().string() + ": " + record,
                          "the file is damaged: export it again");
      }
      if (p.time < last && last - p.time < core::seconds_per_week / 2)
        throw core::Error("time goes back by " + core::format_number(last - p.time, 4) + " s", file.path().string() + ": " + record,
                          "export the records in the order of their time");
      if (p.time == last) {
        tally.count("CSD pulses at a repeated time, left out", record);
        continue;
      }
      last = p.time;
      const bool end = first + i + 1 == file.pulses();
      const double since = out.size() ? p.time - out.time.back() : 0.0;
      if (out.size() && !end && since >= 0 && since < spacing.value) {
        tally.count("CSD pulses between the poses that are taken, left out");
        continue;
      }
      out.time.push_back(p.time);
      out.latitude.push_back(p.latitude);
      out.longitude.push_back(p.longitude);
      out.height.push_back(p.height);
      out.roll.push_back(p.roll);
      out.pitch.push_back(p.pitch);
      out.heading.push_back(p.heading);
    }
  }
  tally.read("CSD pulses", file.pulses());
  tally.keep("CSD pulses", out.size());
  tally.read("trajectory records", out.size());
  return out;
}

}  // namespace swath::io
