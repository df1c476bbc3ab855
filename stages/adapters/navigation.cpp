// SPDX-License-Identifier: GPL-3.0-or-later
// IMU and GNSS records of a survey enter the run.
#include <algorithm>
#include <map>

#include "core/error.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/gnss_file.h"
#include "io/imu_file.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/place.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;

struct NoOptions {};
template <class V>
void describe(NoOptions&, V&) {}

void tell_span(const std::vector<double>& time, core::Value& findings) {
  if (time.empty()) return;
  findings["first_utc"] = core::utc_text(time.front());
  findings["last_utc"] = core::utc_text(time.back());
  findings["seconds"] = time.back() - time.front();
}

class ImuReader : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"readers.imu", "Reads the survey's IMU records as increments in body axes.", {Grain::survey}, {}, {}, {},
                           {Product::imu}};
    return info;
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::ImuFile& f : survey.imu) out.push_back(io::resolve(survey, f.file));
    return out;
  }
  void check(const Context& context) const override {
    if (context.survey.imu.empty())
      throw core::usage_error("readers.imu: the survey names no [[imu]] file", context.survey.name,
                              "a survey with a given trajectory begins with readers.trajectory");
  }
  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    auto imu = std::make_shared<core::ImuData>(io::read_imu(context.survey, tally));
    findings["records"] = imu->size();
    if (imu->size()) findings["rate_hz"] = 1.0 / core::median(imu->step);
    tell_span(imu->time, findings);
    context.imu = std::move(imu);
  }
};

class GnssReader : public OptionStage<NoOptions> {
 public:
  const Info& info() const override {
    static const Info info{"readers.gnss", "Reads the survey's GNSS positions (text, RTKLIB, NMEA).", {Grain::survey}, {}, {}, {},
                           {Product::gnss}};
    return info;
  }
  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    for (const io::GnssFile& f : survey.gnss) out.push_back(io::resolve(survey, f.file));
    return out;
  }
  void check(const Context& context) const override {
    if (context.survey.gnss.empty())
      throw core::usage_error("readers.gnss: the survey names no [[gnss]] file", context.survey.name,
                              "a survey with a given trajectory begins with readers.trajectory");
  }
  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    auto gnss = std::make_shared<core::GnssData>(io::read_gnss(context.survey, tally));
    findings["fixes"] = gnss->size();
    tell_span(gnss->time, findings);
    std::map<core::FixQuality, std::uint64_t> kinds;
    for (const core::FixQuality q : gnss->quality) ++kinds[q];
    for (const auto& [quality, n] : kinds) findings["quality"][core::Choices<core::FixQuality>::names[static_cast<size_t>(quality)]] = n;
    if (gnss->has_velocity())
      findings["with_velocity"] =
          std::count_if(gnss->velocity.begin(), gnss->velocity.end(), [](const Eigen::Vector3d& v) { return v.allFinite(); });
    context.gnss = std::move(gnss);
    check_place_of_fixes(context);
  }
};

}  // namespace

std::unique_ptr<Stage> make_imu_reader() { return std::make_unique<ImuReader>(); }
std::unique_ptr<Stage> make_gnss_reader() { return std::make_unique<GnssReader>(); }

}  // namespace swath::stages
