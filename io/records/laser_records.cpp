// SPDX-License-Identifier: GPL-3.0-or-later
// A LAZ file is read from its start to reach a later place (its points have no addresses); the other formats are entered anywhere.
#include "io/records/laser_records.h"

#include <algorithm>
#include <numeric>

#include "core/block.h"
#include "core/error.h"
#include "io/las/las_box.h"
#include "io/las/las_reader.h"
#include "io/records/csd.h"
#include "io/text/binary_file.h"
#include "io/text/delimited.h"
#include "io/text/npy.h"

namespace swath::io {
namespace {

/// The columns that a survey names and where their values go.
struct RecordColumns {
  std::vector<std::string> names;
  std::vector<std::vector<double> LaserRecords::*> to;
};

RecordColumns columns_of(const LaserColumns& c, Wanted wanted) {
  RecordColumns out;
  const auto add = [&](const std::string& name, std::vector<double> LaserRecords::*to) {
    if (name.empty()) return;
    out.names.push_back(name);
    out.to.push_back(to);
  };
  add(c.time, &LaserRecords::time);
  add(c.week, &LaserRecords::week);
  add(c.line, &LaserRecords::line);
  if (wanted == Wanted::plan) return out;
  add(c.scan_angle, &LaserRecords::angle);
  add(c.range, &LaserRecords::range);
  add(c.x, &LaserRecords::x);
  add(c.y, &LaserRecords::y);
  add(c.z, &LaserRecords::z);
  add(c.intensity, &LaserRecords::intensity);
  add(c.return_number, &LaserRecords::return_number);
  add(c.return_count, &LaserRecords::return_count);
  return out;
}

class TextRecords : public LaserRecordReader {
 public:
  TextRecords(const std::filesystem::path& path, const LaserFile& f, Wanted wanted, const LaserPlace& from, std::uint64_t end)
      : columns_(columns_of(f.columns, wanted)),
        places_(wanted == Wanted::plan),
        layout_(inspect_delimited(path, f.delimiter)),
        reader_(path, layout_, indices(path), from.line ? from.byte : layout_.data_begin, from.line ? from.line : layout_.data_line),
        row_(columns_.names.size()),
        record_(from.record),
        end_(end) {}

  bool next(LaserRecords& out, size_t most) override {
    out.clear();
    const size_t n = columns_.to.size();
    std::vector<std::vector<double>*> to(n);
    for (size_t c = 0; c < n; ++c) to[c] = &(out.*columns_.to[c]);
    while (out.record.size() < most && record_ < end_ && reader_.next(row_.data())) {
      for (size_t c = 0; c < n; ++c) to[c]->push_back(row_[c]);
      out.record.push_back(record_++);
      if (!places_) continue;
      out.byte.push_back(reader_.offset());
      out.text_line.push_back(reader_.line());
    }
    return !out.record.empty();
  }

 private:
  std::vector<size_t> indices(const std::filesystem::path& path) const {
    std::vector<size_t> out;
    for (const std::string& name : columns_.names) out.push_back(column_of(layout_, name, path));
    return out;
  }
  RecordColumns columns_;
  bool places_;
  DelimitedLayout layout_;
  DelimitedReader reader_;
  std::vector<double> row_;
  std::uint64_t record_, end_;
};

class NpyRecords : public LaserRecordReader {
 public:
  NpyRecords(const std::filesystem::path& path, const LaserFile& f, Wanted wanted, const LaserPlace& from, std::uint64_t end)
      : columns_(columns_of(f.columns, wanted)), reader_(path, fields(path)), record_(from.record), end_(std::min(end, reader_.rows())) {}

  bool next(LaserRecords& out, size_t most) override {
    out.clear();
    const size_t n = record_ < end_ ? static_cast<size_t>(std::min<std::uint64_t>(most, end_ - record_)) : 0;
    if (n == 0) return false;
    reader_.read(record_, n, values_);
    for (size_t c = 0; c < values_.size(); ++c) std::swap(out.*columns_.to[c], values_[c]);
    for (size_t i = 0; i < n; ++i) out.record.push_back(record_++);
    return true;
  }

 private:
  std::vector<size_t> fields(const std::filesystem::path& path) const {
    const NpyHeader header = read_npy_header(path);
    std::vector<size_t> out;
    for (const std::string& name : columns_.names) out.push_back(field_of(header, name, path));
    return out;
  }
  RecordColumns columns_;
  NpyReader reader_;
  std::uint64_t record_, end_;
  std::vector<std::vector<double>> values_;
};

class CsdRecords : public LaserRecordReader {
 public:
  CsdRecords(const std::filesystem::path& path, const LaserPlace& from, std::uint64_t end)
      : reader_(path), record_(from.record), end_(std::min(end, reader_.pulses())) {}

  bool next(LaserRecords& out, size_t most) override {
    out.clear();
    // A stretch of pulses without a return gives no records, but is not the end.
    while (out.record.empty() && record_ < end_) {
      const size_t n = static_cast<size_t>(std::min<std::uint64_t>(std::max<size_t>(most / 4, 1), end_ - record_));
      reader_.read(record_, n, pulses_);
      for (const CsdPulse& p : pulses_) {
        for (int k = 0; k < p.return_count; ++k) {
          out.record.push_back(record_);
          out.time.push_back(p.time);
          out.angle.push_back(p.scan_angle);
          out.range.push_back(p.range[static_cast<size_t>(k)]);
          out.intensity.push_back(p.intensity[static_cast<size_t>(k)]);
          out.return_number.push_back(k + 1);
          out.return_count.push_back(p.return_count);
        }
        ++record_;
      }
    }
    return !out.record.empty();
  }

 private:
  CsdReader reader_;
  std::uint64_t record_, end_;
  std::vector<CsdPulse> pulses_;
};

class LasRecords : public LaserRecordReader {
 public:
  LasRecords(const std::filesystem::path& path, Wanted wanted, const LaserPlace& from, std::uint64_t end)
      : wanted_(wanted),
        header_(read_las_header(path, ignored_)),
        record_(from.record),
        end_(std::min<std::uint64_t>(end, header_.point_count)) {
    if (!las_layout(header_.point_format)->gps)
      throw core::Error("point format " + std::to_string(header_.point_format) + " has no GPS time", path.string(),
                        "export the records in format 1, 3 or 6 and up");
    if (!header_.compressed) {
      file_ = std::make_unique<BinaryFile>(path);
      return;
    }
    reader_ = std::make_unique<LasReader>(path, 1u);
    for (std::uint64_t at = 0; at < record_;) {
      const size_t n = reader_->read(points_, static_cast<size_t>(std::min<std::uint64_t>(record_ - at, 65536)));
      if (n == 0) break;
      at += n;
    }
  }

  bool next(LaserRecords& out, size_t most) override {
    out.clear();
    size_t n = record_ < end_ ? static_cast<size_t>(std::min<std::uint64_t>(most, end_ - record_)) : 0;
    if (n == 0) return false;
    if (reader_) {
      n = reader_->read(points_, n);
      if (n == 0) return false;
    } else {
      bytes_.resize(n * header_.record_length);
      file_->read(header_.offset_to_points + record_ * header_.record_length, bytes_.data(), bytes_.size());
      if (wanted_ == Wanted::plan)
        decode_las_lines(bytes_, header_, out.time, out.line);
      else
        decode_las_points(bytes_, header_, points_);
    }
    out.record.resize(n);
    std::iota(out.record.begin(), out.record.end(), record_);
    record_ += n;
    if (wanted_ == Wanted::plan && !reader_) return true;
    const LasPoints& p = points_;
    out.time = p.gps_time;
    out.line.assign(p.point_source_id.begin(), p.point_source_id.end());
    if (wanted_ == Wanted::plan) return true;
    out.x = p.x;
    out.y = p.y;
    out.z = p.z;
    out.intensity.assign(p.intensity.begin(), p.intensity.end());
    out.return_number.assign(p.return_number.begin(), p.return_number.end());
    out.return_count.assign(p.return_count.begin(), p.return_count.end());
    out.flags.resize(n);
    for (size_t i = 0; i < n; ++i)
      out.flags[i] = static_cast<std::uint16_t>(p.flags[i] | (p.scan_direction[i] ? core::flag::scan_direction : 0) |
                                                (p.edge_of_line[i] ? core::flag::edge_of_line : 0));
    return true;
  }

  void take(size_t i) override { box_.add_one(points_, header_, record_ - points_.size(), i); }
  void count_oddities(const std::string& name, core::Tally& tally) const override { box_.count(name, tally); }

 private:
  std::vector<std::string> ignored_;
  Wanted wanted_;
  LasHeader header_;
  LasBox box_;
  std::unique_ptr<BinaryFile> file_;
  std::unique_ptr<LasReader> reader_;
  LasPoints points_;
  std::vector<std::uint8_t> bytes_;
  std::uint64_t record_, end_;
};

}  // namespace

void LaserRecords::clear() {
  for (auto* c : {&time, &week, &line, &angle, &range, &x, &y, &z, &intensity, &return_number, &return_count}) c->clear();
  flags.clear();
  for (auto* c : {&record, &byte, &text_line}) c->clear();
}

std::unique_ptr<LaserRecordReader> open_laser_records(const Survey& survey, const LaserFile& f, Wanted wanted, const LaserPlace& from,
                                                      std::uint64_t end) {
  const std::filesystem::path path = resolve(survey, f.file);
  switch (format_of(f)) {
    case LaserFormat::text:
      return std::make_unique<TextRecords>(path, f, wanted, from, end);
    case LaserFormat::npy:
      return std::make_unique<NpyRecords>(path, f, wanted, from, end);
    case LaserFormat::csd:
      return std::make_unique<CsdRecords>(path, from, end);
    case LaserFormat::las:
      return std::make_unique<LasRecords>(path, wanted, from, end);
    case LaserFormat::automatic:
      break;
  }
  throw core::usage_error("the name does not tell the format of the laser records", path.string(),
                          "state format = \"text\", \"npy\", \"las\" or \"csd\"");
}

TimeTags time_of(const Survey& survey, const LaserFile& f) {
  TimeTags tags = f.time;
  if (format_of(f) == LaserFormat::csd && tags.week) hold_csd_week(resolve(survey, f.file), *tags.week);
  if (tags.scale != core::TimeScale::unstated) return tags;
  const std::filesystem::path path = resolve(survey, f.file);
  if (format_of(f) == LaserFormat::csd) {
    tags.scale = core::TimeScale::gps_week;
    if (!tags.week) tags.week = CsdReader(path).header().gps_week;
  } else if (format_of(f) == LaserFormat::las) {
    std::vector<std::string> ignored;
    if (read_las_header(path, ignored).gps_time_is_adjusted()) {
      tags.scale = core::TimeScale::gps_adjusted;
    } else if (tags.week) {
      tags.scale = core::TimeScale::gps_week;
    } else {
      throw core::usage_error("the file's times are seconds of the GPS week, and the week is not stated", path.string(),
                              "state time = {scale = \"gps_week\", week = ...}");
    }
  }
  return tags;
}

}  // namespace swath::io
