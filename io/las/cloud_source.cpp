// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/las/cloud_source.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "core/grid_units.h"
#include "core/time.h"
#include "io/las/cloud_crs.h"
#include "io/las/cloud_rim.h"
#include "io/survey/wild_records.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

/// How coordinates of a cloud's file become those of the map.
struct CloudPlace {
  std::optional<core::Transform> transform;
  double file_height_unit = 1.0, map_height_unit = 1.0;  ///< as in CloudSource
  bool is_same() const { return !transform && file_height_unit == 1.0; }
};

CloudPlace place_of(const Survey& survey, const CloudMap& map, const PointFile& file, const LasCrs& stated) {
  CloudPlace place;
  const core::Crs crs = cloud_crs(survey, file);
  if (!core::is_same_crs(crs, map.crs)) place.transform.emplace(crs, map.crs);
  // PROJ takes heights of a known system in the CRS's own unit; those of an unknown one it hands through.
  const bool handed_through = !place.transform || crs.heights() == core::Heights::unknown;
  place.file_height_unit = height_unit(survey, file, crs, stated.vertical_metres);
  place.file_height_unit /= handed_through ? map.vertical_unit : crs.vertical_metres_per_unit();
  if (std::abs(place.file_height_unit - 1.0) < 1e-9) place.file_height_unit = 1.0;  // one unit, printed with other digits
  if (!handed_through) place.map_height_unit = map.vertical_unit / map.crs.vertical_metres_per_unit();
  return place;
}

/// How times of a cloud's file are read: those of an unknown scale stay as they are.
LasTime times_of(const PointFile& file) { return {file.week, true, file.time_scale, file.date}; }

LasHeader header_of(const fs::path& file) {
  std::vector<std::string> ignored;
  return read_las_header(file, ignored);
}

}  // namespace

std::vector<LasSource> cloud_sources(const Survey& survey, const CloudMap& map) {
  std::vector<LasSource> out;
  for (const PointFile& f : survey.points) {
    LasSource& s = out.emplace_back(LasSource{resolve(survey, f.file), {}, times_of(f), true});
    s.header = header_of(s.file);
    s.same_places = place_of(survey, map, f, las_crs(s.header)).is_same();
  }
  return out;
}

bool keeps_crs(const std::vector<LasSource>& sources, const core::Crs& map) {
  return std::all_of(sources.begin(), sources.end(), [&](const LasSource& s) {
    const std::string stated = las_crs(s.header).definition;
    if (!s.same_places || stated.empty()) return false;
    try {
      return core::is_same_crs(core::Crs(stated), map);
    } catch (const core::Error&) {  // not known to PROJ: the survey states another
      return false;
    }
  });
}

bool has_weekless_times(const Survey& survey) {
  std::vector<fs::path> weekless, dated;
  for (const PointFile& f : survey.points) {
    const fs::path file = resolve(survey, f.file);
    const LasHeader header = header_of(file);
    if (header.point_count == 0 || !las_layout(header.point_format)->gps) continue;
    (las_time_scale(header, times_of(f)) == core::TimeScale::unstated ? weekless : dated).push_back(file);
  }
  if (!weekless.empty() && !dated.empty())
    throw core::Error("times are seconds of a GPS week that is not stated, while those of " + dated.front().string() + " are dated",
                      weekless.front().string(), "state points.week or points.time_scale for it in the survey");
  return !weekless.empty();
}

CloudSource::CloudSource(const Survey& survey, size_t cloud, const CloudMap& map, const Eigen::Vector2d& rim, const CloudExtent& extent,
                         const LasPart& part)
    : file_(survey.points[cloud]),
      number_(part.unused.has(core::Column::source) ? 0 : static_cast<std::uint32_t>(cloud + 1)),
      map_(map),
      reader_(resolve(survey, file_.file), 0, part),
      rim_(rim),
      extent_(extent),
      time_(times_of(file_)) {
  CloudPlace place = place_of(survey, map, file_, reader_.crs());
  transform_ = std::move(place.transform);
  file_height_unit_ = place.file_height_unit;
  map_height_unit_ = place.map_height_unit;
  has_unknown_times_ =
      las_layout(reader_.header().point_format)->gps && las_time_scale(reader_.header(), time_) == core::TimeScale::unstated;
}

bool CloudSource::next(core::Block& out, size_t most, core::Tally& tally) {
  core::Block block;
  block.origin = map_.origin;
  core::scale_block(1.0 / map_.unit, 1.0 / map_.vertical_unit, block);
  const size_t n = reader_.read(block, most, time_, number_);
  if (n == 0) {
    const std::string outside = reader_.box().fault();
    reader_.box().count(file_.file.string(), tally);
    for (const std::string& w : reader_.warnings())
      if (w != outside) tally.count("oddities of the file", w);
    if (const std::string fault = reader_.time_fault(file_.time_scale); !fault.empty())
      tally.count("times contradict the file's GPS time bit, kept as they are", file_.file.string() + ": " + fault);
    return false;
  }
  keep_near(block, tally);
  set_unknown_times(block, tally);
  if (!transform_) keep_rim_inside(block, rim_, reader_.header().scale.head<2>());
  if (file_height_unit_ != 1.0)
    for (double& z : block.z) z *= file_height_unit_;
  if (transform_) convert(block, tally);
  core::scale_block(map_.unit, map_.vertical_unit, block);
  block.origin = map_.origin;
  core::keep_in_area(map_.area, block, file_.file.string(), tally);
  tally.keep("points", block.size());
  if (file_.line) block.strip.assign(block.size(), static_cast<std::uint16_t>(*file_.line));
  if (has_unknown_times_ && block.size() > 0)
    tally.count("times of no stated week or scale (points.week, points.time_scale), kept as they are", block.size());
  core::add_columns(
      block, {core::Column::time, core::Column::intensity, core::Column::return_number, core::Column::return_count,
              core::Column::classification, core::Column::flags, core::Column::scan_angle, core::Column::strip, core::Column::record});
  out = std::move(block);
  return true;
}

/// Points that lie alone, far from all others of the file; block in the file's coordinates.
void CloudSource::keep_near(core::Block& block, core::Tally& tally) {
  const auto is_far = [&](size_t i) { return !extent_.holds(block.x[i] + block.origin.x(), block.y[i] + block.origin.y()); };
  std::uint64_t far = 0;
  for (size_t i = 0; i < block.size(); ++i) far += is_far(i);
  if (far == 0) return;
  far_ += far;
  core::leave_out(block, is_far, "points alone far from all others of their file, left out", file_.file.string(), tally);
  if (extent_.is_stated() && !are_few(far_, reader_.count()))
    throw core::Error("points lie far from the box that the file's header states", file_.file.string(),
                      "the header is wrong: write the file again with a tool that makes its box from the points");
}

/// An impossible time is 0 for the stages; the file's own goes to the product.
void CloudSource::set_unknown_times(core::Block& block, core::Tally& tally) const {
  constexpr double max_weekless = 1e10;
  for (size_t i = 0; i < block.time.size(); ++i) {
    const double t = block.time[i];
    if (has_unknown_times_ ? std::abs(t) < max_weekless : is_instant(t)) continue;
    tally.count("points with an impossible time, taken as unknown",
                file_.file.string() + ": record " + std::to_string(block.record[i]) + ": " + core::format_number(t) + " s");
    block.time[i] = 0.0;
  }
}

void CloudSource::convert(core::Block& block, core::Tally& tally) {
  for (size_t i = 0; i < block.size(); ++i) {
    block.x[i] += block.origin.x();
    block.y[i] += block.origin.y();
    block.z[i] += block.origin.z();
  }
  const size_t bad = transform_->apply(block.x.data(), block.y.data(), block.z.data(), block.size());
  std::vector<std::uint32_t> good;
  for (std::uint32_t i = 0; i < block.size(); ++i) {
    if (!std::isfinite(block.x[i])) continue;
    good.push_back(i);
    block.x[i] -= block.origin.x();
    block.y[i] -= block.origin.y();
    block.z[i] = block.z[i] / map_height_unit_ - block.origin.z();
  }
  if (bad) {
    tally.count("points without coordinates in the CRS, left out", bad);
    block = core::select(block, good);
  }
}

}  // namespace swath::io
