// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/las_cloud.h"

#include <algorithm>
#include <array>

#include "core/error.h"
#include "core/geo/crs.h"
#include "core/geo/same_map.h"
#include "io/las/cloud_crs.h"
#include "io/las/las_crs.h"
#include "io/las/las_reader.h"
#include "pipeline/progress.h"

namespace swath::python {
namespace {

using core::Value;

constexpr size_t points_at_once = 1u << 18;

/// Appends the columns of a batch to those of the files.
class Collector {
 public:
  Collector(LasCloud& cloud, const std::optional<std::vector<std::string>>& wanted, std::uint64_t total)
      : cloud_(cloud), wanted_(wanted), total_(total) {}

  /// Extra fields of a file. Throws core::Error where one has another type than in a file before.
  void begin(const io::LasHeader& header, const std::filesystem::path& file) {
    for (const io::LasExtra& e : header.extras) {
      if (!keeps(e.name)) continue;
      const auto same =
          std::find_if(cloud_.extras.begin(), cloud_.extras.end(), [&](const ExtraColumn& c) { return c.field.name == e.name; });
      if (same == cloud_.extras.end()) {
        cloud_.extras.push_back({e, {}, {}});
      } else if (same->field.type != e.type || same->field.bytes != e.bytes || same->field.scale != e.scale ||
                 same->field.offset != e.offset || same->field.nodata != e.nodata) {
        throw core::Error("the extra field " + e.name + " has another type or scale than in the files before", file.string(),
                          "read the files one by one, or leave the field out of `columns`");
      }
    }
  }
  void append(const io::LasPoints& batch, const io::LasHeader& header) {
    const size_t n = batch.size(), before = cloud_.size;
    for_each_las_column([&](const char* name, auto member) {
      auto& to = cloud_.points.*member;
      const auto& from = batch.*member;
      if (!keeps(name) || (from.empty() && to.empty())) return;
      to.reserve(total_);
      to.resize(before);
      to.insert(to.end(), from.begin(), from.end());
      to.resize(before + n);
    });
    for (ExtraColumn& c : cloud_.extras) append_extra(c, batch, header, before, n);
    cloud_.size += n;
  }

 private:
  bool keeps(const std::string& name) const { return !wanted_ || std::find(wanted_->begin(), wanted_->end(), name) != wanted_->end(); }

  void append_extra(ExtraColumn& c, const io::LasPoints& batch, const io::LasHeader& header, size_t before, size_t n) const {
    const std::optional<int> place = header.extra_offset(c.field.name);
    if (c.has_numbers()) {
      c.numbers.reserve(total_);
      const std::vector<double> values = place ? io::las_extra_values(batch, header, c.field.name) : std::vector<double>(n);
      c.numbers.resize(before);
      c.numbers.insert(c.numbers.end(), values.begin(), values.end());
      return;
    }
    const auto width = static_cast<size_t>(c.field.size()), stride = static_cast<size_t>(header.extra_bytes());
    c.bytes.reserve(total_ * width);
    c.bytes.resize(before * width);
    for (size_t i = 0; i < n && place; ++i) {
      const std::uint8_t* from = batch.extra.data() + i * stride + static_cast<size_t>(*place);
      c.bytes.insert(c.bytes.end(), from, from + width);
    }
    c.bytes.resize((before + n) * width);
  }

  LasCloud& cloud_;
  const std::optional<std::vector<std::string>>& wanted_;
  std::uint64_t total_;
};

void expect_alike(const LasCloud& cloud, const io::LasReader& reader, const std::filesystem::path& first,
                  const std::filesystem::path& file) {
  if (reader.header().gps_time_is_adjusted() != cloud.header.gps_time_is_adjusted())
    throw core::Error("its times are on another scale than those of " + first.string(), file.string(), "read the files one by one");
  const std::string crs = reader.crs().definition;
  const bool same = crs == cloud.crs || (!crs.empty() && !cloud.crs.empty() && core::is_same_crs(core::Crs(crs), core::Crs(cloud.crs)));
  if (!same)
    throw core::Error("its CRS is not that of " + first.string(), file.string(), "read the files one by one, and transform one of them");
}

Value numbers(const Eigen::Vector3d& v) { return Value(Value::Array{v[0], v[1], v[2]}); }

Eigen::Vector3d vector_in(const Value& v, const char* key) {
  const Value::Array& a = v.find(key)->items();
  return {a.at(0).as_number(), a.at(1).as_number(), a.at(2).as_number()};
}

}  // namespace

LasCloud read_cloud(const std::vector<std::filesystem::path>& files, const std::optional<std::vector<std::string>>& wanted,
                    unsigned threads, const std::atomic<bool>& stop) {
  LasCloud cloud;
  std::vector<io::LasReader> readers;
  std::uint64_t total = 0;
  for (const std::filesystem::path& file : files) {
    const io::LasReader& reader = readers.emplace_back(file, threads);
    total += reader.header().point_count;
    if (readers.size() == 1) {
      cloud.header = reader.header();
      cloud.crs = reader.crs().definition;
    }
    expect_alike(cloud, reader, files.front(), file);
  }
  Collector collector(cloud, wanted, total);
  for (size_t i = 0; i < files.size(); ++i) {
    collector.begin(readers[i].header(), files[i]);
    io::LasPoints batch;
    while (readers[i].read(batch, points_at_once) > 0) {
      if (stop) throw pipeline::Interrupted();
      collector.append(batch, readers[i].header());
    }
    for (const std::string& w : readers[i].warnings()) cloud.warnings.push_back(files[i].string() + ": " + w);
  }
  return cloud;
}

Value value_of(const io::LasHeader& h) {
  Value out = Value::object();
  out["scale"] = numbers(h.scale);
  out["offset"] = numbers(h.offset);
  out["point_format"] = h.point_format;
  out["adjusted"] = h.gps_time_is_adjusted();
  out["file_source_id"] = h.file_source_id;
  return out;
}

io::LasHeader header_of(const Value& v, const std::string& crs) {
  io::LasHeader h;
  h.scale = vector_in(v, "scale");
  h.offset = vector_in(v, "offset");
  h.point_format = static_cast<int>(v.find("point_format")->as_int());
  h.file_source_id = static_cast<std::uint16_t>(v.find("file_source_id")->as_int());
  if (v.find("adjusted")->as_bool()) h.global_encoding |= io::las_encoding::adjusted_gps_time;
  if (h.point_format >= 6) h.global_encoding |= io::las_encoding::wkt;
  h.system_identifier = h.generating_software = "swath";
  if (!crs.empty()) io::add_las_wkt(h, core::Crs(crs).wkt1());
  return h;
}

}  // namespace swath::python
