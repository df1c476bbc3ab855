// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/survey/record_checks.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/config/option_visitors.h"
#include "core/error.h"
#include "io/records/event_marks.h"
#include "io/records/laser_records.h"
#include "io/survey/survey_checks.h"
#include "io/survey/wild_records.h"
#include "io/text/delimited.h"
#include "io/text/npy.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;
using core::Value;

constexpr size_t first_records = 4096;  // a mirror's whole sweep at 100 Hz and 400 kHz
constexpr double full_turn = 2 * core::pi * (1 + 1e-9);

class RecordChecks {
 public:
  RecordChecks(const Survey& survey, const Value& tree) : survey_(survey), tree_(tree) {}

  void all() {
    each("laser", survey_.laser, [&](LaserFile& f, const std::string& key) {
      const LaserFormat format = format_of(f);
      if (format != LaserFormat::text && format != LaserFormat::npy) return;
      if (columns(f, key, format == LaserFormat::npy)) angles(f, key);
    });
    each("trajectory", survey_.trajectory, [&](TrajectoryFile& f, const std::string& key) {
      if (format_of(f) == TrajectoryFormat::text) columns(f, key, false);
    });
    each("event", survey_.events, [&](EventFile& f, const std::string& key) {
      if (format_of(f, resolve(survey_, f.file)) == EventFormat::text) columns(f, key, false);
    });
    each("imu", survey_.imu, [&](ImuFile& f, const std::string& key) { columns(f, key, format_of(f) == RecordFormat::npy); });
    each("gnss", survey_.gnss, [&](GnssFile& f, const std::string& key) {
      if (format_of(f) == GnssFormat::text) columns(f, key, false);
    });
    core::throw_if_any(faults_);
  }

 private:
  template <class File, class Check>
  void each(const char* name, const std::vector<File>& files, const Check& check) {
    for (size_t i = 0; i < files.size(); ++i) {
      File copy = files[i];
      check(copy, std::string(name) + "[" + std::to_string(i + 1) + "]");
    }
  }

  void fault(const std::string& key, const core::Error& e) {
    const std::string what = e.where().empty() ? std::string(e.what()) : e.where() + ": " + e.what();
    faults_.push_back({place_in(tree_, key), key, what, e.hint()});
  }

  /// Does the file have every column that is named?
  template <class File>
  bool columns(File& f, const std::string& key, bool npy) {
    const fs::path path = resolve(survey_, f.file);
    const Value named = core::effective_values(core::described(f.columns));
    bool whole = true;
    const auto look = [&](const auto& has) {
      for (const auto& [column, name] : named.members()) {
        if (!name.is_text() || name.as_text().empty()) continue;
        try {
          has(name.as_text());
        } catch (const core::Error& e) {
          fault(key + ".columns." + column, e);
          whole = false;
        }
      }
    };
    try {
      if (npy) {
        const NpyHeader header = read_npy_header(path);
        look([&](const std::string& name) { field_of(header, name, path); });
      } else {
        const DelimitedLayout layout = inspect_delimited(path, f.delimiter);
        look([&](const std::string& name) { column_of(layout, name, path); });
      }
    } catch (const core::Error&) {
      return false;  // damaged: the reader names the place
    }
    return whole;
  }

  /// The first scan angles in the unit stated.
  void angles(const LaserFile& f, const std::string& key) {
    if (model_of(survey_, f) == core::ScannerModel::profile && survey_.scanner.model != core::ScannerModel::profile) return;
    const double unit = radians_per(f.angle_unit);
    if (f.columns.scan_angle.empty() || unit == 0.0) return;
    LaserRecords records;
    try {
      open_laser_records(survey_, f, Wanted::all)->next(records, first_records);
    } catch (const core::Error&) {
      return;  // the reader names the record
    }
    const auto is_beyond = [&](double angle) { return std::isfinite(angle) && std::abs(angle * unit) > full_turn; };
    const auto beyond = static_cast<std::uint64_t>(std::count_if(records.angle.begin(), records.angle.end(), is_beyond));
    if (are_few(beyond, records.angle.size())) return;  // of single records: those are left out
    for (size_t i = 0; i < records.angle.size(); ++i)
      if (is_beyond(records.angle[i]))
        return fault(
            key + ".angle_unit",
            core::Error("a scan angle of " + core::format_number(records.angle[i]) + " in " +
                            std::string(core::Choices<AngleUnit>::names[static_cast<size_t>(f.angle_unit)]) + " is more than a full turn",
                        resolve(survey_, f.file).string() + ": record " + std::to_string(records.record[i]),
                        f.angle_unit == AngleUnit::rad ? "are the angles in degrees? State angle_unit = \"deg\""
                                                       : "check angle_unit and columns.scan_angle"));
  }

  const Survey& survey_;
  const Value& tree_;
  std::vector<core::Fault> faults_;
};

}  // namespace

void check_records(const Survey& survey, const core::Value& tree) { RecordChecks(survey, tree).all(); }

}  // namespace swath::io
