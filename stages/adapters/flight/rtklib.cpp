// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/statistics.h"
#include "core/time.h"
#include "io/gnss/pos_writer.h"
#include "io/gnss/rinex_header.h"
#include "io/gnss/rtklib_pos.h"
#include "io/gnss/rtklib_run.h"
#include "io/text/output_file.h"
#include "io/text/process.h"
#include "stages/adapters/adapters.h"
#include "stages/adapters/flight/rtklib_bases.h"
#include "trajectory/gnss_combine.h"

namespace swath::stages {
namespace {

namespace fs = std::filesystem;
using core::FixQuality;

constexpr double dynamics_step = 2.0;       // s; with longer ones RTKLIB's prediction falls outside its own gate
constexpr double check_step = 30.0;         // s between the fixes of a receiver by itself
constexpr double low_share_of_fixed = 0.5;  // below, the report warns
constexpr double complete = 0.999;          // of the rover's epochs or of its span, above which nothing is missing
constexpr const char* folder_name = "gnss";

struct RtklibStageOptions : io::RtklibOptions {
  fs::path program{"rnx2rtkp"};
  core::Metres max_distance{50000.0};
  std::string bases = "nearest";
  double agreement = 5.0;
  core::Metres base_tolerance{50.0};
  core::Seconds time_limit{7200.0};
};

/// "nearest" is 1, "all" any number; 0 where the text is neither, nor a number above 0.
size_t number_of_bases(const std::string& text) {
  if (text == "nearest") return 1;
  if (text == "all") return std::numeric_limits<size_t>::max();
  if (text.empty() || text.size() > 3 || text.find_first_not_of("0123456789") != std::string::npos) return 0;
  return static_cast<size_t>(std::stoi(text));
}

template <class V>
void describe(RtklibStageOptions& o, V& v) {
  v.option("program", o.program, "RTKLIB's program rnx2rtkp: a file, or a name looked up on PATH (Debian package rtklib).");
  v.option("max_distance", o.max_distance, core::above(0), "Farthest base from the rover's approximate position.");
  v.option("bases", o.bases, "Bases within max_distance that are used: \"nearest\", \"all\", or the number of the nearest, \"2\".");
  v.option("agreement", o.agreement, core::above(0),
           "Several bases: fixed solutions of one epoch within this many sigmas agree and are averaged.");
  v.option("base_tolerance", o.base_tolerance, core::above(0),
           "Farthest that a base's own code solution may lie from its stated position.");
  v.option("time_limit", o.time_limit, core::above(0), "Longest time for one run of rnx2rtkp, which is ended then.");
  describe(static_cast<io::RtklibOptions&>(o), v);
  v.check(number_of_bases(o.bases) > 0, "bases is \"nearest\", \"all\" or a number from \"1\"");
}

std::string fixed_text(double value, int digits) {
  char text[48];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return text;
}

void tell(const trajectory::GnssAccount& a, core::Value& v) {
  v["epochs"] = a.fixes;
  for (size_t q = 0; q < a.by_quality.size(); ++q)
    if (a.by_quality[q] > 0 || q == static_cast<size_t>(FixQuality::fixed) || q == static_cast<size_t>(FixQuality::float_ambiguity))
      v[std::string(core::Choices<FixQuality>::names[q])] = a.by_quality[q];
  v["fixed_percent"] = 100 * a.share(FixQuality::fixed);
  v["first"] = core::utc_text(a.first);
  v["last"] = core::utc_text(a.last);
  v["gaps"] = a.gaps;
  v["longest_gap_s"] = a.longest_gap;
}

class Rtklib : public OptionStage<RtklibStageOptions> {
 public:
  const Info& info() const override {
    static const Info info{"gnss.rtklib",
                           "Antenna positions from raw GNSS observations of the aircraft and of base stations, by RTKLIB's rnx2rtkp.",
                           {Grain::survey},
                           {},
                           {},
                           {},
                           {Product::of<core::GnssData>()}};
    return info;
  }
  std::vector<std::string> products() const override { return {folder_name}; }

  std::vector<fs::path> inputs(const io::Survey& survey) const override {
    std::vector<fs::path> out;
    const auto add = [&](const std::vector<fs::path>& files) {
      for (const fs::path& f : files) out.push_back(io::resolve(survey, f));
    };
    add(survey.rinex.rover);
    add(survey.rinex.navigation);
    for (const io::BaseStation& b : survey.rinex.bases) add(b.observations);
    if (survey.rinex.antenna_file) add({*survey.rinex.antenna_file});
    return out;
  }

  void check(const Context& context) const override {
    const io::Rinex& r = context.survey.rinex;
    const auto refuse = [&](const std::string& what, const std::string& hint) {
      throw core::usage_error("gnss.rtklib: " + what, context.survey.name, hint);
    };
    if (r.rover.empty()) refuse("the survey names no rover in [rinex]", "name the aircraft's RINEX observation files: rover = [\"...\"]");
    if (r.navigation.empty()) refuse("the survey names no navigation files in [rinex]", "name RINEX navigation files of the day");
    if (r.bases.empty()) refuse("the survey names no [[rinex.base]]", "differential GNSS needs a base station, at best within 20 km");
    for (const io::BaseStation& b : r.bases)
      if (b.observations.empty()) refuse("the base '" + b.name + "' has no observations", "name its RINEX observation files");
    bool antennas = !r.antenna_type.empty();
    for (const io::BaseStation& b : r.bases) antennas = antennas || !b.antenna_type.empty();
    if (antennas && !r.antenna_file)
      refuse("antenna types are stated, but no antenna_file", "name an ANTEX file in [rinex], or leave the types out");
    if (io::find_program(options.program).empty())
      refuse("the program '" + options.program.string() + "' is not found",
             "install RTKLIB (Debian and Ubuntu: apt-get install rtklib), or name the program: program = \"/path/of/rnx2rtkp\"");
  }

  void run_survey(Context& context, core::Tally& tally, core::Value& findings) const override {
    check(context);
    const fs::path products = context.output / folder_name;
    io::RtklibJob job;
    job.program = io::find_program(options.program);
    job.products = products;
    job.options = options;
    job.time_limit = options.time_limit.value;
    const Receiver rover = scan_receiver(context.survey, context.survey.rinex.rover);
    job.rover = rover.files;
    prepare(context, rover, job, tally);
    std::string place_from = "RINEX header";
    const Eigen::Vector3d place = place_of(rover, job, place_from);
    std::vector<Base> bases = read_bases(context.survey, rover, place, tally);

    core::Value& about = findings["rover"] = core::Value::object();
    about["epochs"] = rover.epochs;
    about["interval_s"] = rover.interval;
    about["first"] = core::utc_text(rover.first);
    about["last"] = core::utc_text(rover.last);
    about["approximate_position_from"] = place_from;
    core::Value& list = findings["bases"] = core::Value::array();
    const std::vector<Base> chosen = choose_bases(bases, rover, options.max_distance.value, number_of_bases(options.bases), list);

    std::vector<core::GnssData> solutions;
    std::vector<std::string> names;
    std::optional<core::Error> failure;
    for (const Base& b : chosen) {
      core::Value one = core::Value::object();
      one["name"] = b.name;
      one["distance_m"] = b.distance;
      one["overlap_percent"] = 100 * b.share_of(rover);
      check_position(b, job, one, tally);
      try {
        core::GnssData fixes = solve(b, job, tally);
        judge(b, rover, fixes, one, tally);
        solutions.push_back(std::move(fixes));
        names.push_back(b.name);
      } catch (const core::SystemError&) {
        throw;
      } catch (const core::Error& e) {
        if (!failure) failure = e;
        one["failed"] = e.text();
        tally.count("bases without a solution", b.name + ": " + e.what());
      }
      list.push(std::move(one));
    }
    if (solutions.empty()) throw *failure;
    context.records.share<core::GnssData>(finish(context, std::move(solutions), names, rover, findings, tally));
  }

 private:
  /// What the job of every base shares: navigation, orbits, the rover's antenna.
  void prepare(const Context& context, const Receiver& rover, io::RtklibJob& job, core::Tally& tally) const {
    const io::Rinex& r = context.survey.rinex;
    bool navigation = false, orbits = false;
    for (const fs::path& name : r.navigation) {
      job.navigation.push_back(io::resolve(context.survey, name));
      const io::RinexKind kind = io::rinex_kind(job.navigation.back());
      if (kind == io::RinexKind::observations || kind == io::RinexKind::other)
        throw core::Error("is no navigation file", job.navigation.back().string(),
                          "[rinex] navigation takes RINEX navigation files, SP3 orbits and RINEX clocks, unpacked");
      navigation = navigation || kind == io::RinexKind::navigation;
      orbits = orbits || kind == io::RinexKind::orbits;
    }
    job.setup.precise_orbits = options.orbits == io::RtklibOrbits::precise || (options.orbits == io::RtklibOrbits::automatic && orbits);
    if (job.setup.precise_orbits && !orbits)
      throw core::usage_error("gnss.rtklib: orbits = \"precise\", but [rinex] navigation names no SP3 file", context.survey.name);
    if (!job.setup.precise_orbits && !navigation)
      throw core::usage_error("gnss.rtklib: [rinex] navigation names no RINEX navigation file", context.survey.name,
                              "broadcast orbits come from navigation files (N, G, H or mixed)");
    if (options.dynamics && rover.interval > dynamics_step)
      throw core::usage_error("gnss.rtklib: dynamics with an epoch every " + core::format_number(rover.interval) + " s",
                              rover.files.front().string(), "RTKLIB's prediction needs an epoch per 2 s or more: dynamics = false");
    if (r.antenna_file) job.antenna_file = io::resolve(context.survey, *r.antenna_file);
    job.setup.rover_antenna.type = antenna_type(job.antenna_file, r.antenna_type, rover, "the rover");
    for (size_t k = 0; k < 3; ++k) job.setup.rover_antenna.offset[static_cast<int>(k)] = r.antenna_offset[k].value;
    if (r.antenna_file && job.setup.rover_antenna.type.empty())
      tally.count("antenna without a type: its phase centre is not applied", "the rover");
  }

  /// A receiver's own solution by code, an epoch per half minute. The files of it do not stay.
  static core::GnssData alone(const io::RtklibJob& shared, const Receiver& receiver) {
    const io::FinishedFiles removed_again;
    io::RtklibJob job = shared;
    job.products /= ".alone";
    job.name = "alone";
    job.rover = receiver.files;
    job.base.clear();
    job.setup.base.reset();
    job.setup.rover_antenna = {};
    job.antenna_file.reset();
    job.every = receiver.interval < check_step ? check_step : 0.0;
    if (receiver.last - receiver.first < 4 * check_step) job.every = 0;
    job.options.direction = io::RtklibDirection::forward;
    job.options.coordinates = io::RtklibCoordinates::ecef;
    job.options.ionosphere = io::RtklibIonosphere::broadcast;
    job.options.troposphere = io::RtklibTroposphere::saastamoinen;
    const struct Cleaner {
      fs::path folder;
      ~Cleaner() {
        std::error_code ignored;
        fs::remove_all(folder, ignored);
      }
    } cleaner{job.products};
    core::Tally ignored;
    return io::read_pos(io::run_rtklib(job), {}, 0.0, ignored);
  }

  static Eigen::Vector3d place_of(const Receiver& rover, const io::RtklibJob& job, std::string& from) {
    if (rover.header.position) return *rover.header.position;
    from = "first fix by code";
    try {
      return alone(job, rover).position.front();
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      throw core::Error("the RINEX header has no approximate position, and no fix was found from code: " + std::string(e.what()),
                        rover.files.front().string(), e.hint());
    }
  }

  /// A base's position against what its own code ranges say: a slip of the pen is found before hours are computed with it.
  void check_position(const Base& b, const io::RtklibJob& job, core::Value& one, core::Tally& tally) const {
    core::GnssData fixes;
    try {
      fixes = alone(job, b.receiver);
    } catch (const core::SystemError&) {
      throw;
    } catch (const core::Error& e) {
      tally.count("base whose position could not be checked", b.name + ": " + e.what());
      return;
    }
    Eigen::Vector3d middle;
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<double> values;
      for (const Eigen::Vector3d& p : fixes.position) values.push_back(p[axis]);
      middle[axis] = core::median(std::move(values));
    }
    const double off = (middle - b.position).norm();
    one["code_solution_off_m"] = off;
    if (off > options.base_tolerance.value)
      throw core::Error("the base '" + b.name + "' lies " + fixed_text(off, 1) + " m from its stated position by its own code ranges",
                        b.receiver.files.front().string(),
                        "its position is that of the marker, ECEF metres; its code ranges say " + fixed_text(middle.x(), 1) + " " +
                            fixed_text(middle.y(), 1) + " " + fixed_text(middle.z(), 1));
  }

  core::GnssData solve(const Base& b, const io::RtklibJob& shared, core::Tally& tally) const {
    io::RtklibJob job = shared;
    job.name = b.file_name;
    job.base = b.receiver.files;
    job.setup.base = b.position;
    job.setup.base_antenna = b.antenna;
    // The engine's folder is named by all inputs and options: a solution of a run that was stopped is this one's.
    const fs::path done = job.products / (job.name + ".pos");
    return io::read_pos(fs::exists(done) ? done : io::run_rtklib(job), {}, 0.0, tally);
  }

  static void judge(const Base& b, const Receiver& rover, const core::GnssData& fixes, core::Value& one, core::Tally& tally) {
    const trajectory::GnssAccount a = trajectory::account_of(fixes, rover.interval);
    tell(a, one);
    const double solved = static_cast<double>(a.fixes) / static_cast<double>(rover.epochs);
    one["rover_epochs_percent"] = 100 * solved;
    double nearest = std::numeric_limits<double>::infinity(), farthest = 0;
    for (const Eigen::Vector3d& p : fixes.position) {
      const double d = (p - b.position).norm();
      nearest = std::min(nearest, d);
      farthest = std::max(farthest, d);
    }
    one["nearest_m"] = nearest;
    one["farthest_m"] = farthest;
    if (b.share_of(rover) < complete)
      tally.count("base that does not record over the whole flight", b.name + ": " + fixed_text(100 * b.share_of(rover), 1) + " % of it");
    if (solved < complete)
      tally.count("epochs of the rover without a solution",
                  b.name + ": longest gap " + fixed_text(a.longest_gap, 1) + " s from " + core::utc_text(a.longest_gap_at),
                  rover.epochs - std::min<std::uint64_t>(a.fixes, rover.epochs));
    if (a.share(FixQuality::fixed) < low_share_of_fixed)
      tally.count("base with fewer than half of the epochs fixed", b.name + ": " + fixed_text(100 * a.share(FixQuality::fixed), 1) + " %");
  }

  std::shared_ptr<const core::GnssData> finish(const Context& context, std::vector<core::GnssData> solutions,
                                               const std::vector<std::string>& names, const Receiver& rover, core::Value& findings,
                                               core::Tally& tally) const {
    auto out = std::make_shared<core::GnssData>();
    if (solutions.size() == 1) {
      *out = std::move(solutions.front());
    } else {
      trajectory::CombinedGnss all = trajectory::combine_gnss(solutions, options.agreement);
      core::Value& told = findings["combined"] = core::Value::object();
      tell(trajectory::account_of(all.data, rover.interval), told);
      told["averaged"] = all.averaged;
      told["disagreeing"] = all.disagreeing;
      for (size_t i = 0; i < names.size(); ++i) told["taken"][names[i]] = all.taken[i];
      if (all.disagreeing) {
        told["worst_disagreement_m"] = all.worst_disagreement;
        tally.count("epochs at which fixed solutions of several bases disagree",
                    fixed_text(all.worst_disagreement, 3) + " m at " + core::utc_text(all.worst_at), all.disagreeing);
      }
      std::string of = "solutions of several bases as one:";
      for (const std::string& n : names) of += " " + n;
      io::write_pos(context.output / folder_name / "combined.pos", all.data, {of});
      *out = std::move(all.data);
    }
    const trajectory::GnssAccount a = trajectory::account_of(*out, rover.interval);
    findings["epochs"] = a.fixes;
    findings["fixed_percent"] = 100 * a.share(FixQuality::fixed);
    findings["longest_gap_s"] = a.longest_gap;
    for (double& t : out->time) t += context.survey.antenna.latency.value;
    return out;
  }
};

}  // namespace

std::unique_ptr<Stage> make_rtklib() { return std::make_unique<Rtklib>(); }

}  // namespace swath::stages
