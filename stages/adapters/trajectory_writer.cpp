// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/error.h"
#include "core/time.h"
#include "io/sbet.h"
#include "io/trajectory_text.h"
#include "stages/adapters/adapters.h"

namespace swath::stages {

enum class TrajectoryOutput { sbet, text, covariance };

}  // namespace swath::stages

namespace swath::core {
template <>
struct Choices<stages::TrajectoryOutput> {
  static constexpr std::array<std::string_view, 3> names{"sbet", "text", "covariance"};
};
}  // namespace swath::core

namespace swath::stages {
namespace {

struct TrajectoryWriteOptions {
  std::string name = "trajectory";
  std::vector<TrajectoryOutput> formats{TrajectoryOutput::sbet, TrajectoryOutput::text, TrajectoryOutput::covariance};
  core::TimeScale time = core::TimeScale::gps_week;
};

template <class V>
void describe(TrajectoryWriteOptions& o, V& v) {
  v.option("name", o.name, "Name of the files within the output, without ending.");
  v.option(
      "formats", o.formats,
      "sbet: NAME.sbet, and NAME.smrmsg with the standard deviations where the trajectory has them; text: NAME.csv, every record with its "
      "velocity and standard deviations; covariance: NAME_covariance.csv, the 9 x 9 covariance of position, velocity and attitude at the "
      "smoother's nodes (upper triangle), between which it is linear in time.");
  v.option("time", o.time, "Time scale of the text files (SBET: seconds of week).");
  v.check(!o.formats.empty(), "at least one format");
  v.check(o.time != core::TimeScale::unstated && o.time != core::TimeScale::device,
          "the time scale must be stated, and none of a device's own");
}

class TrajectoryWriter : public OptionStage<TrajectoryWriteOptions> {
 public:
  const Info& info() const override {
    static const Info info{"writers.trajectory",
                           "Trajectory as SBET with smrmsg and as delimited text with its covariances.",
                           {Grain::survey},
                           {},
                           {},
                           {Product::trajectory},
                           {}};
    return info;
  }
  std::vector<std::string> products() const override {
    std::vector<std::string> out;
    if (wants(TrajectoryOutput::sbet)) out.insert(out.end(), {options.name + ".sbet", options.name + ".smrmsg"});
    if (wants(TrajectoryOutput::text)) out.push_back(options.name + ".csv");
    if (wants(TrajectoryOutput::covariance)) out.push_back(options.name + "_covariance.csv");
    return out;
  }
  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    const core::TrajectoryData& data = context.trajectory->data();
    const auto file = [&](const char* ending) { return context.output / (options.name + ending); };
    if (wants(TrajectoryOutput::sbet)) {
      io::write_sbet(file(".sbet"), data);
      if (data.has_sigma()) io::write_smrmsg(file(".smrmsg"), data);
      findings["sbet_gps_week"] = core::week_of(data.time.front());
    }
    if (wants(TrajectoryOutput::text)) io::write_trajectory_text(file(".csv"), data, options.time);
    if (wants(TrajectoryOutput::covariance)) {
      if (data.covariance.empty())
        tally.count("the trajectory has no covariances: " + options.name + "_covariance.csv is not written");
      else
        io::write_covariance_text(file("_covariance.csv"), data, options.time);
    }
    findings["records"] = data.size();
  }

 private:
  bool wants(TrajectoryOutput f) const { return std::find(options.formats.begin(), options.formats.end(), f) != options.formats.end(); }
};

}  // namespace

std::unique_ptr<Stage> make_trajectory_writer() { return std::make_unique<TrajectoryWriter>(); }

}  // namespace swath::stages
