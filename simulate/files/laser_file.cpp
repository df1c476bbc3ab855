// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/laser_file.h"

#include <cmath>

#include "io/las/las_writer.h"
#include "io/text/npy.h"
#include "io/text/text_rows.h"

namespace swath::simulate {
namespace {

bool has_vectors(const Options& o) { return model_of(o.scanner.pattern) == core::ScannerModel::beam; }

Eigen::Vector3d recorded_vector(const Returns& r, size_t i) {
  const double w = std::sqrt(1 - r.forward[i] * r.forward[i]);
  return r.range[i] * Eigen::Vector3d(r.forward[i], w * std::sin(r.angle[i]), w * std::cos(r.angle[i]));
}

const char* const angle_header = "time_s,line,scan_angle_deg,range_m,intensity,return_number,return_count\n";
const char* const vector_header = "time_s,line,x_m,y_m,z_m,intensity,return_number,return_count\n";

class CsvWriter : public LaserFileWriter {
 public:
  CsvWriter(const std::filesystem::path& file, const Options& o)
      : options_(o), rows_(file, has_vectors(o) ? vector_header : angle_header) {}

  void append(const Returns& r) override {
    for (size_t i = 0; i < r.size(); ++i) {
      rows_.shortest(time_in(options_.output.time, r.time[i]));
      rows_.number(r.line[i], 0);
      if (has_vectors(options_)) {
        const Eigen::Vector3d v = recorded_vector(r, i);
        for (const double c : {v.x(), v.y(), v.z()}) length(c);
      } else {
        if (options_.noise.noise_free)
          rows_.shortest(r.angle[i] / core::degree);
        else
          rows_.number(r.angle[i] / core::degree, 7);
        length(r.range[i]);
      }
      rows_.number(r.intensity[i], 0);
      rows_.number(r.number[i], 0);
      rows_.number(r.count[i], 0);
      rows_.end();
    }
  }
  void finish() override { rows_.commit(); }

 private:
  void length(double v) {
    if (options_.noise.noise_free)
      rows_.shortest(v);
    else
      rows_.number(v, 6);
  }
  const Options& options_;
  io::TextRows rows_;
};

class NpyRecords : public LaserFileWriter {
 public:
  NpyRecords(const std::filesystem::path& file, const Options& o) : options_(o), out_(file, columns(o)) {}

  void append(const Returns& r) override {
    const size_t n = r.size();
    time_.resize(n);
    for (auto& c : value_) c.resize(n);
    for (size_t i = 0; i < n; ++i) {
      time_[i] = time_in(options_.output.time, r.time[i]);
      if (has_vectors(options_)) {
        const Eigen::Vector3d v = recorded_vector(r, i);
        for (size_t k = 0; k < 3; ++k) value_[k][i] = v[static_cast<Eigen::Index>(k)];
      } else {
        value_[0][i] = r.angle[i] / core::degree;
        value_[1][i] = r.range[i];
      }
    }
    std::vector<const double*> values{time_.data(), r.line.data(), value_[0].data(), value_[1].data()};
    if (has_vectors(options_)) values.push_back(value_[2].data());
    for (const auto* c : {&r.intensity, &r.number, &r.count}) values.push_back(c->data());
    out_.append(values, n);
  }
  void finish() override { out_.commit(); }

 private:
  static std::vector<io::NpyColumn> columns(const Options& o) {
    std::vector<io::NpyColumn> c{{"time", "f8"}, {"line", "u2"}};
    if (has_vectors(o))
      c.insert(c.end(), {{"x", "f8"}, {"y", "f8"}, {"z", "f8"}});
    else
      c.insert(c.end(), {{"scan_angle_deg", "f8"}, {"range", "f8"}});
    c.insert(c.end(), {{"intensity", "u2"}, {"return_number", "u1"}, {"return_count", "u1"}});
    return c;
  }
  const Options& options_;
  io::NpyWriter out_;
  std::vector<double> time_;
  std::array<std::vector<double>, 3> value_;
};

/// LAS 1.4 format 6 in the scanner's frame. Coordinates in steps of 1 um up to 2 km of range, 0.1 mm beyond.
class LasRecords : public LaserFileWriter {
 public:
  LasRecords(const std::filesystem::path& file, const Options& o) : options_(o), out_(file, header(o)) {}

  void append(const Returns& r) override {
    io::LasPoints p;
    const size_t n = r.size();
    for (auto* c : {&p.raw_x, &p.raw_y, &p.raw_z}) c->resize(n);
    for (auto* c : {&p.return_number, &p.return_count, &p.scan_direction, &p.edge_of_line}) c->resize(n);
    p.intensity.resize(n);
    p.raw_scan_angle.resize(n);
    p.point_source_id.resize(n);
    p.gps_time.resize(n);
    const core::TimeScale time = scale_of(options_);
    for (size_t i = 0; i < n; ++i) {
      const Eigen::Vector3d v = recorded_vector(r, i) / step(options_);
      p.raw_x[i] = static_cast<std::int32_t>(std::lround(v.x()));
      p.raw_y[i] = static_cast<std::int32_t>(std::lround(v.y()));
      p.raw_z[i] = static_cast<std::int32_t>(std::lround(v.z()));
      p.return_number[i] = static_cast<std::uint8_t>(r.number[i]);
      p.return_count[i] = static_cast<std::uint8_t>(r.count[i]);
      p.scan_direction[i] = r.positive[i] > 0.5;
      p.edge_of_line[i] = r.edge[i] > 0.5;
      p.intensity[i] = static_cast<std::uint16_t>(r.intensity[i]);
      p.raw_scan_angle[i] = static_cast<std::int16_t>(std::lround(r.angle[i] / core::degree / 0.006));
      p.point_source_id[i] = static_cast<std::uint16_t>(r.line[i]);
      p.gps_time[i] = time_in(time, r.time[i]);
    }
    out_.write(p);
  }
  void finish() override { out_.finish(); }

  static core::TimeScale scale_of(const Options& o) {
    return o.output.time == core::TimeScale::gps_week ? core::TimeScale::gps_week : core::TimeScale::gps_adjusted;
  }

 private:
  static double step(const Options& o) { return o.flight.height.value < 700.0 ? 1e-6 : 1e-4; }
  static io::LasHeader header(const Options& o) {
    io::LasHeader h;
    h.point_format = 6;
    h.scale.setConstant(step(o));
    if (scale_of(o) == core::TimeScale::gps_adjusted) h.global_encoding |= io::las_encoding::adjusted_gps_time;
    h.global_encoding |= io::las_encoding::wkt;
    h.system_identifier = "swath simulate";
    h.generating_software = "swath";
    return h;
  }
  const Options& options_;
  io::LasRawWriter out_;
};

}  // namespace

double time_in(core::TimeScale scale, core::GpsTime t) {
  switch (scale) {
    case core::TimeScale::gps_adjusted:
      return t - core::adjusted_offset;
    case core::TimeScale::gps_week:
      return core::seconds_of_week(t);
    case core::TimeScale::unix_utc:
      return core::to_unix(t);
    case core::TimeScale::utc_day:
      return std::fmod(core::to_unix(t), 86400.0);
    case core::TimeScale::gps:
    case core::TimeScale::device:
    case core::TimeScale::unstated:
      break;
  }
  return t;
}

io::TimeTags tags_of(core::TimeScale scale, core::GpsTime first) {
  io::TimeTags tags;
  tags.scale = scale;
  if (scale == core::TimeScale::gps_week) tags.week = core::week_of(first);
  if (scale == core::TimeScale::utc_day) tags.date = core::utc_text(first).substr(0, 10);
  return tags;
}

std::filesystem::path laser_name(Format format) {
  switch (format) {
    case Format::csv:
      return "laser.csv";
    case Format::npy:
      return "laser.npy";
    case Format::las:
      return "laser.las";
    case Format::laz:
      return "laser.laz";
  }
  return "laser.npy";
}

std::unique_ptr<LaserFileWriter> open_laser_file(const std::filesystem::path& folder, Format format, const Options& options) {
  const std::filesystem::path file = folder / laser_name(format);
  switch (format) {
    case Format::csv:
      return std::make_unique<CsvWriter>(file, options);
    case Format::npy:
      return std::make_unique<NpyRecords>(file, options);
    case Format::las:
    case Format::laz:
      return std::make_unique<LasRecords>(file, options);
  }
  return nullptr;
}

io::LaserFile describe_laser_file(Format format, const Options& options, core::GpsTime first) {
  io::LaserFile f;
  f.file = laser_name(format);
  if (format == Format::las || format == Format::laz) {
    f.time = tags_of(LasRecords::scale_of(options), first);
    return f;
  }
  f.time = tags_of(options.output.time, first);
  const bool csv = format == Format::csv;
  f.columns.time = csv ? "time_s" : "time";
  f.columns.line = "line";
  f.columns.intensity = "intensity";
  f.columns.return_number = "return_number";
  f.columns.return_count = "return_count";
  if (has_vectors(options)) {
    f.columns.x = csv ? "x_m" : "x";
    f.columns.y = csv ? "y_m" : "y";
    f.columns.z = csv ? "z_m" : "z";
  } else {
    f.columns.range = csv ? "range_m" : "range";
    f.columns.scan_angle = "scan_angle_deg";
    f.angle_unit = io::AngleUnit::deg;
  }
  return f;
}

struct TruthFile::State {
  explicit State(const std::filesystem::path& file)
      : out(file, {{"t", "f8"},
                   {"X", "f8"},
                   {"Y", "f8"},
                   {"Z", "f8"},
                   {"e", "f8"},
                   {"n", "f8"},
                   {"h", "f8"},
                   {"range", "f8"},
                   {"angle", "f8"},
                   {"bx", "f8"},
                   {"by", "f8"},
                   {"bz", "f8"},
                   {"cls", "u1"},
                   {"rn", "u1"},
                   {"nr", "u1"},
                   {"line", "u2"}}) {}
  io::NpyWriter out;
};

TruthFile::TruthFile(const std::filesystem::path& file) : state_(std::make_unique<State>(file)) {}
TruthFile::~TruthFile() = default;

void TruthFile::append(const Returns& r) {
  std::vector<const double*> values;
  for (const auto* c : {&r.true_time, &r.x, &r.y, &r.z, &r.east, &r.north, &r.height, &r.true_range, &r.true_angle, &r.beam_x, &r.beam_y,
                        &r.beam_z, &r.kind, &r.number, &r.count, &r.line})
    values.push_back(c->data());
  state_->out.append(values, r.size());
}

void TruthFile::finish() { state_->out.commit(); }

}  // namespace swath::simulate
