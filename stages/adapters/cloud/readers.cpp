// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/error.h"
#include "core/geo/same_map.h"
#include "io/copc/cloud_part.h"
#include "io/las/cloud_crs.h"
#include "io/las/cloud_extent.h"
#include "io/records/laser_checks.h"
#include "io/records/laser_file.h"
#include "io/records/trajectory_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/cloud/clouds.h"
#include "stages/adapters/flight/place.h"
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
  std::vector<fs::path> inputs(const io::Survey& survey) const override { return files_in<&io::Survey::laser>(survey); }
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

class CloudStrip : public StripReader {
 public:
  CloudStrip(const Context& context, size_t cloud, const Eigen::Vector2d& rim, const io::CloudExtent& extent, const io::CloudPart& part)
      : source_(context.survey, cloud, cloud_map(context), rim, extent, {part.chunks, context.unread}) {}
  bool next(StripBatch& batch, size_t most, core::Tally& tally) override { return source_.next(batch.block, most, tally); }

 private:
  io::CloudSource source_;
};

struct CloudOptions {
  std::optional<std::array<double, 4>> bounds;
  std::optional<core::Metres> resolution;
};

template <class V>
void describe(CloudOptions& o, V& v) {
  v.option("bounds", o.bounds, "West, south, east, north in units of the CRS: points outside are not read, or left out.");
  v.option("resolution", o.resolution, core::above(0.0), "COPC and EPT: only levels needed for points this far apart; unset: all points.");
  v.check(!o.bounds || ((*o.bounds)[0] < (*o.bounds)[2] && (*o.bounds)[1] < (*o.bounds)[3]), "bounds are west, south, east, north");
}

class LasCloud : public OptionStage<CloudOptions> {
 public:
  const Info& info() const override {
    static const Info info{"readers.las",
                           "Reads the survey's point clouds in map coordinates: LAS, LAZ, COPC, EPT, or what a virtual point cloud lists.",
                           {Grain::strip},
                           {},
                           {Column::x, Column::y, Column::z, Column::time, Column::intensity, Column::return_number, Column::return_count,
                            Column::classification, Column::flags, Column::scan_angle, Column::strip, Column::record, Column::source},
                           {},
                           {Product::points}};
    return info;
  }
  bool is_source() const override { return true; }
  std::vector<fs::path> inputs(const io::Survey& survey) const override { return files_in<&io::Survey::points>(survey); }
  void check(const Context& context) const override {
    if (context.survey.points.empty())
      throw core::usage_error("readers.las: the survey names no [[points]] file", context.survey.name,
                              "for raw records use readers.laser and georeference");
    io::check_clouds(context.survey);
  }
  std::string own_crs(const io::Survey& survey) const override {
    return survey.points.empty() ? std::string() : io::cloud_definition(survey, survey.points.front());
  }
  void locate(Context& context) const override {
    context.weekless = io::has_weekless_times(context.survey);
    extents_.clear();
    const auto threads = static_cast<unsigned>(context.threads);
    bool has_origin = false, any_height = false;
    Box places{Area::none, Area::none, -Area::none, -Area::none};
    for (const io::PointFile& f : context.survey.points) {
      const core::Crs crs = io::cloud_crs(context.survey, f);
      const double unit = crs.is_geographic() ? metres_per_degree : crs.metres_per_unit();
      io::FileExtent found =
          io::extent_of_cloud(io::resolve(context.survey, f.file), 1000.0 / unit, context.area.lowest / context.vertical_unit,
                              context.area.highest / context.vertical_unit, threads);
      // Geocentric coordinates, or a maker's own: none of them is known to be wrong.
      any_height = any_height || !found.has_few_wild_heights;
      const io::CloudExtent& e = extents_.emplace_back(std::move(found.places));
      if (e.points() == 0) continue;
      std::optional<core::Transform> transform;
      if (!core::is_same_crs(crs, context.crs)) transform.emplace(crs, context.crs);
      if (!has_origin) {  // of the first file with points
        const Eigen::Vector3d corner(e.low().x(), e.low().y(), 0.0);
        context.origin = origin_near(context, transform ? (*transform)(corner) : corner);
        has_origin = true;
      }
      add_places(places, context, e, transform);
    }
    if (any_height) context.area.lowest = -Area::none, context.area.highest = Area::none;
    if (places.x0 <= places.x1) set_area(context, places, around_clouds);
    if (options.bounds) {
      const auto& [west, south, east, north] = *options.bounds;
      Box& box = context.area.box;
      box = {std::max(box.x0, west * context.unit), std::max(box.y0, south * context.unit), std::min(box.x1, east * context.unit),
             std::min(box.y1, north * context.unit)};
    }
    if (context.crs.heights() == core::Heights::unknown) context.heights = io::heights_of_clouds(context.survey);
  }
  std::vector<Strip> strips(const Context& context, core::Tally& tally) const override {
    std::vector<Strip> out;
    parts_.clear();
    std::uint64_t unread = 0;
    rim_.setConstant(-std::numeric_limits<double>::infinity());
    const auto resolution = options.resolution ? std::optional(options.resolution->value) : std::nullopt;
    for (size_t i = 0; i < context.survey.points.size(); ++i) {
      const io::PointFile& f = context.survey.points[i];
      const io::CloudPart& part = parts_.emplace_back(io::part_of_cloud(context.survey, f, cloud_map(context), resolution));
      if (extents_[i].points() > 0) rim_ = rim_.cwiseMax(extents_[i].high());
      unread += part.unread;
      if (part.points == 0 && part.unread > 0) continue;
      out.push_back({i, 0, f.line.value_or(0), f.file.string(), part.points});
      tally.read("points", part.points);
    }
    if (out.empty() && unread > 0)
      throw core::Error("no point of the clouds lies within the bounds", context.survey.name,
                        "bounds are west, south, east, north in units of the CRS; see `swath info` of the clouds");
    if (unread > 0) tally.count("points of nodes outside the area or below the resolution, not read", unread);
    return out;
  }
  std::unique_ptr<StripReader> open(const Context& context, const Strip& strip) const override {
    return std::make_unique<CloudStrip>(context, strip.source, rim_, extents_[strip.source], parts_[strip.source]);
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
  mutable std::vector<io::CloudPart> parts_;      // what of them is read
  mutable Eigen::Vector2d rim_;                   // of the run, found once before the files are read
};

}  // namespace

Entry laser_reader_stage() { return {"readers.laser", std::make_unique<LaserReader>}; }
Entry las_reader_stage() { return {"readers.las", std::make_unique<LasCloud>}; }

}  // namespace swath::stages
