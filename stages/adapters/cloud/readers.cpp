// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/time.h"
#include "io/las/cloud_extent.h"
#include "io/las/cloud_rim.h"
#include "io/las/las_reader.h"
#include "io/records/laser_checks.h"
#include "io/records/laser_file.h"
#include "io/records/trajectory_file.h"
#include "io/survey/wild_records.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/cloud_crs.h"
#include "stages/adapters/cloud/clouds.h"
#include "stages/adapters/flight/place.h"
#include "stages/adapters/units.h"
#include "stages/area.h"
#include "trajectory/checks.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::Column;

class LaserStrip : public StripReader {
 public:
  LaserStrip(const io::Survey& survey, const io::StripInfo& strip) : source_(survey, strip) {}
  bool next(StripBatch& batch, size_t most, core::Tally& tally) override {
    if (source_.next(batch.shots, most)) return true;
    tally.add(source_.tally());
    return false;
  }

 private:
  io::LaserSource source_;
};

class LaserReader : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{
        "readers.laser",
        "Reads the survey's raw laser records (text, NumPy, LAS or LAZ in the scanner's frame, Optech CSD), line by line.",
        {Grain::strip},
        {},
        {},
        {},
        {Product::shots},
        {Product::of<trajectory::Trajectory>()}};
    return info;
  }
  bool is_source() const override { return true; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::LaserFile& f : survey.laser) out.push_back(io::resolve(survey, f.file));
    return out;
  }
  std::vector<Strip> strips(const Context& context, core::Tally& tally) const override {
    strips_ = io::scan(context.survey, tally);
    io::check_laser(context.survey, strips_, tally);
    std::vector<Strip> out;
    for (size_t i = 0; i < strips_.size(); ++i)
      out.push_back({strips_[i].file, i, strips_[i].line, strips_[i].name(context.survey), strips_[i].records, strips_[i].first_time,
                     strips_[i].last_time});
    return out;
  }
  std::unique_ptr<StripReader> open(const Context& context, const Strip& strip) const override {
    if (const auto* flown = record<trajectory::Trajectory>(context)) io::hold_common_times(context.survey, strips_, flown->data().time);
    return std::make_unique<LaserStrip>(context.survey, strips_[strip.index]);
  }
  void check(const Context& context) const override {
    if (context.survey.laser.empty())
      throw core::usage_error("readers.laser: the survey names no [[laser]] file", context.survey.name, "for point clouds use readers.las");
  }

 private:
  mutable std::vector<io::StripInfo> strips_;  // of the run, found once before the strips are read
};

/// Are the clouds' times seconds of a week that neither file nor survey names? Throws core::Error where only some of the files' times are.
bool has_weekless_times(const io::Survey& survey) {
  std::vector<fs::path> weekless, dated;
  for (const io::PointFile& f : survey.points) {
    std::vector<std::string> ignored;
    const fs::path file = io::resolve(survey, f.file);
    const io::LasHeader header = io::read_las_header(file, ignored);
    if (header.point_count == 0 || !io::las_layout(header.point_format)->gps) continue;
    (io::las_time_scale(header, times_of(f)) == core::TimeScale::unstated ? weekless : dated).push_back(file);
  }
  if (!weekless.empty() && !dated.empty())
    throw core::Error("times are seconds of a GPS week that is not stated, while those of " + dated.front().string() + " are dated",
                      weekless.front().string(), "state points.week or points.time_scale for it in the survey");
  return !weekless.empty();
}

/// Reads a point cloud in map coordinates, converted to the CRS and metres of the run.
class CloudReader : public StripReader {
 public:
  /// `rim`: largest coordinates of the survey's files; `extent`: of this one.
  CloudReader(const Context& context, const Strip& strip, const Eigen::Vector2d& rim, const io::CloudExtent& extent)
      : context_(context),
        file_(context.survey.points[strip.source]),
        number_(static_cast<std::uint32_t>(strip.source + 1)),
        reader_(io::resolve(context.survey, file_.file)),
        rim_(rim),
        extent_(extent),
        place_(place_of(context, file_, reader_.crs())),
        time_(times_of(file_)) {
    has_unknown_times_ =
        io::las_layout(reader_.header().point_format)->gps && io::las_time_scale(reader_.header(), time_) == core::TimeScale::unstated;
  }

  bool next(StripBatch& batch, size_t most, core::Tally& tally) override {
    core::Block block;
    block.origin = context_.origin;
    scale_block(context_, block, true);
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
    if (!place_.transform) io::keep_rim_inside(block, rim_, reader_.header().scale.head<2>());
    if (place_.file_height_unit != 1.0)
      for (double& z : block.z) z *= place_.file_height_unit;
    if (place_.transform) convert(block, tally);
    scale_block(context_, block, false);
    block.origin = context_.origin;
    core::keep_in_area(context_.area, block, file_.file.string(), tally);
    tally.keep("points", block.size());
    if (file_.line) block.strip.assign(block.size(), static_cast<std::uint16_t>(*file_.line));
    if (has_unknown_times_ && block.size() > 0)
      tally.count("times of no stated week or scale (points.week, points.time_scale), kept as they are", block.size());
    core::add_columns(block, {Column::time, Column::intensity, Column::return_number, Column::return_count, Column::classification,
                              Column::flags, Column::scan_angle, Column::strip, Column::record});
    batch.block = std::move(block);
    return true;
  }

 private:
  /// Points that lie alone, far from all others of the file; block in the file's coordinates.
  void keep_near(core::Block& block, core::Tally& tally) {
    const auto is_far = [&](size_t i) { return !extent_.holds(block.x[i] + block.origin.x(), block.y[i] + block.origin.y()); };
    std::uint64_t far = 0;
    for (size_t i = 0; i < block.size(); ++i) far += is_far(i);
    if (far == 0) return;
    far_ += far;
    core::leave_out(block, is_far, "points alone far from all others of their file, left out", file_.file.string(), tally);
    if (extent_.is_stated() && !io::are_few(far_, reader_.header().point_count))
      throw core::Error("points lie far from the box that the file's header states", file_.file.string(),
                        "the header is wrong: write the file again with a tool that makes its box from the points");
  }
  /// An impossible time is 0 for the stages; the file's own goes to the product.
  void set_unknown_times(core::Block& block, core::Tally& tally) const {
    constexpr double max_weekless = 1e10;
    for (size_t i = 0; i < block.time.size(); ++i) {
      const double t = block.time[i];
      if (has_unknown_times_ ? std::abs(t) < max_weekless : io::is_instant(t)) continue;
      tally.count("points with an impossible time, taken as unknown",
                  file_.file.string() + ": record " + std::to_string(block.record[i]) + ": " + core::format_number(t) + " s");
      block.time[i] = 0.0;
    }
  }
  void convert(core::Block& block, core::Tally& tally) {
    for (size_t i = 0; i < block.size(); ++i) {
      block.x[i] += block.origin.x();
      block.y[i] += block.origin.y();
      block.z[i] += block.origin.z();
    }
    const size_t bad = place_.transform->apply(block.x.data(), block.y.data(), block.z.data(), block.size());
    std::vector<std::uint32_t> good;
    for (std::uint32_t i = 0; i < block.size(); ++i) {
      if (!std::isfinite(block.x[i])) continue;
      good.push_back(i);
      block.x[i] -= block.origin.x();
      block.y[i] -= block.origin.y();
      block.z[i] = block.z[i] / place_.map_height_unit - block.origin.z();
    }
    if (bad) {
      tally.count("points without coordinates in the CRS, left out", bad);
      block = core::select(block, good);
    }
  }

  const Context& context_;
  const io::PointFile& file_;
  std::uint32_t number_;
  io::LasReader reader_;
  Eigen::Vector2d rim_;
  const io::CloudExtent& extent_;
  CloudPlace place_;
  io::LasTime time_;
  bool has_unknown_times_ = false;
  std::uint64_t far_ = 0;  // points far from the others so far
};

class LasCloud : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"readers.las",
                           "Reads the survey's point clouds, LAS or LAZ in map coordinates.",
                           {Grain::strip},
                           {},
                           {Column::x, Column::y, Column::z, Column::time, Column::intensity, Column::return_number, Column::return_count,
                            Column::classification, Column::flags, Column::scan_angle, Column::strip, Column::record, Column::source},
                           {},
                           {Product::points}};
    return info;
  }
  bool is_source() const override { return true; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::PointFile& f : survey.points) out.push_back(io::resolve(survey, f.file));
    return out;
  }
  void check(const Context& context) const override {
    if (context.survey.points.empty())
      throw core::usage_error("readers.las: the survey names no [[points]] file", context.survey.name,
                              "for raw records use readers.laser and georeference");
    check_clouds(context.survey);
  }
  std::string own_crs(const io::Survey& survey) const override {
    return survey.points.empty() ? std::string() : cloud_definition(survey, survey.points.front());
  }
  void locate(Context& context) const override {
    context.weekless = has_weekless_times(context.survey);
    extents_.clear();
    const auto threads = static_cast<unsigned>(context.threads);
    bool has_origin = false, any_height = false;
    Box places{Area::none, Area::none, -Area::none, -Area::none};
    for (const io::PointFile& f : context.survey.points) {
      const core::Crs crs = cloud_crs(context.survey, f);
      const double unit = crs.is_geographic() ? metres_per_degree : crs.metres_per_unit();
      io::FileExtent found =
          io::extent_of_cloud(io::resolve(context.survey, f.file), 1000.0 / unit, context.area.lowest / context.vertical_unit,
                              context.area.highest / context.vertical_unit, threads);
      // Geocentric coordinates, or a maker's own: none of them is known to be wrong.
      any_height = any_height || !found.has_few_wild_heights;
      const io::CloudExtent& e = extents_.emplace_back(std::move(found.places));
      if (e.points() == 0) continue;
      std::optional<core::Transform> transform;
      if (!is_same_crs(crs, context.crs)) transform.emplace(crs, context.crs);
      if (!has_origin) {  // of the first file with points
        const Eigen::Vector3d corner(e.low().x(), e.low().y(), 0.0);
        context.origin = origin_near(context, transform ? (*transform)(corner) : corner);
        has_origin = true;
      }
      add_places(places, context, e, transform);
    }
    if (any_height) context.area.lowest = -Area::none, context.area.highest = Area::none;
    if (places.x0 <= places.x1) set_area(context, places, around_clouds);
    if (context.crs.heights() == core::Heights::unknown) context.heights = heights_of_clouds(context.survey);
  }
  std::vector<Strip> strips(const Context& context, core::Tally& tally) const override {
    std::vector<Strip> out;
    rim_.setConstant(-std::numeric_limits<double>::infinity());
    for (size_t i = 0; i < context.survey.points.size(); ++i) {
      const io::PointFile& f = context.survey.points[i];
      std::vector<std::string> ignored;
      const io::LasHeader header = io::read_las_header(io::resolve(context.survey, f.file), ignored);
      out.push_back({i, 0, f.line.value_or(0), f.file.string(), header.point_count});
      tally.read("points", header.point_count);
      if (extents_[i].points() > 0) rim_ = rim_.cwiseMax(extents_[i].high());
    }
    return out;
  }
  std::unique_ptr<StripReader> open(const Context& context, const Strip& strip) const override {
    return std::make_unique<CloudReader>(context, strip, rim_, extents_[strip.source]);
  }

 private:
  static constexpr double metres_per_degree = 111e3;

  /// Widens `places` (map metres) by points along the border of a file's points.
  static void add_places(Box& places, const Context& context, const io::CloudExtent& e, const std::optional<core::Transform>& transform) {
    constexpr int steps = 8;
    std::vector<double> x, y, z;
    for (int j = 0; j <= steps; ++j)
      for (int i = 0; i <= steps; ++i) {
        x.push_back(e.low().x() + (e.high().x() - e.low().x()) * i / steps);
        y.push_back(e.low().y() + (e.high().y() - e.low().y()) * j / steps);
        z.push_back(0.0);
      }
    if (transform) transform->apply(x.data(), y.data(), z.data(), x.size());
    for (size_t k = 0; k < x.size(); ++k) {
      const double east = x[k] * context.unit, north = y[k] * context.unit;
      if (!std::isfinite(east + north)) continue;
      places = {std::min(places.x0, east), std::min(places.y0, north), std::max(places.x1, east), std::max(places.y1, north)};
    }
  }

  mutable std::vector<io::CloudExtent> extents_;  // of the run's files
  mutable Eigen::Vector2d rim_;                   // of the run, found once before the files are read
};

}  // namespace

CloudPlace place_of(const Context& context, const io::PointFile& file, const io::LasCrs& stated) {
  CloudPlace place;
  const core::Crs crs = cloud_crs(context.survey, file);
  if (!is_same_crs(crs, context.crs)) place.transform.emplace(crs, context.crs);
  // PROJ takes heights of a known system in the CRS's own unit; those of an unknown one it hands through.
  const bool handed_through = !place.transform || crs.heights() == core::Heights::unknown;
  place.file_height_unit = height_unit(context.survey, file, crs, stated.vertical_metres);
  place.file_height_unit /= handed_through ? context.vertical_unit : crs.vertical_metres_per_unit();
  if (std::abs(place.file_height_unit - 1.0) < 1e-9) place.file_height_unit = 1.0;  // one unit, printed with other digits
  if (!handed_through) place.map_height_unit = context.vertical_unit / context.crs.vertical_metres_per_unit();
  return place;
}

io::LasTime times_of(const io::PointFile& file) { return {file.week, true, file.time_scale, file.date}; }

std::vector<io::LasSource> cloud_sources(const Context& context) {
  std::vector<io::LasSource> out;
  for (const io::PointFile& f : context.survey.points) {
    std::vector<std::string> ignored;
    io::LasSource& s = out.emplace_back(io::LasSource{io::resolve(context.survey, f.file), {}, times_of(f), true});
    s.header = io::read_las_header(s.file, ignored);
    s.same_places = place_of(context, f, io::las_crs(s.header)).is_same();
  }
  return out;
}

bool keeps_crs(const Context& context, const std::vector<io::LasSource>& sources) {
  return std::all_of(sources.begin(), sources.end(), [&](const io::LasSource& s) {
    const std::string stated = io::las_crs(s.header).definition;
    if (!s.same_places || stated.empty()) return false;
    try {
      return is_same_crs(core::Crs(stated), context.crs);
    } catch (const core::Error&) {  // not known to PROJ: the survey states another
      return false;
    }
  });
}

std::unique_ptr<Stage> make_laser_reader() { return std::make_unique<LaserReader>(); }
std::unique_ptr<Stage> make_las_reader() { return std::make_unique<LasCloud>(); }

}  // namespace swath::stages
