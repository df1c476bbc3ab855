// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulate/files/survey_file.h"

#include "core/config/option_visitors.h"
#include "io/text/toml_text.h"

namespace swath::simulate {
namespace {

using core::Value;

bool same(const Value& a, const Value& b) {
  return a.kind() == b.kind() && !a.is_object() && !io::is_table_list(a) && (a.is_null() || io::toml_scalar(a) == io::toml_scalar(b));
}

/// Without the values that `fallback` has too.
Value pruned(const Value& v, const Value& fallback) {
  Value out = Value::object();
  for (const auto& [key, item] : v.members()) {
    const Value* other = fallback.find(key);
    if (item.is_object()) {
      Value inner = pruned(item, other ? *other : Value::object());
      if (!inner.members().empty()) out[key] = std::move(inner);
    } else if (!other || !same(item, *other)) {
      out[key] = item;
    }
  }
  return out;
}

template <class S>
Value effective(S s) {
  return core::effective_values(core::described(s));
}

/// What the accuracy rests on is stated in full, defaults or not.
bool is_full(const std::string& key) { return key == "calibration" || key == "sigma" || key == "name" || key == "crs" || key == "line"; }

/// The defaults of one table of a list.
Value fallback_of(const std::string& list) {
  if (list == "laser") return effective(io::LaserFile{});
  if (list == "trajectory") return effective(io::TrajectoryFile{});
  if (list == "imu") return effective(io::ImuFile{});
  if (list == "gnss") return effective(io::GnssFile{});
  if (list == "clock") {
    // The format of a log cannot be derived from its name: it is always stated.
    Value v = effective(io::ClockLog{});
    *v.find("format") = Value{};
    return v;
  }
  if (list == "event") return effective(io::EventFile{});
  if (list == "camera") {
    Value v = effective(io::SurveyCamera{});
    for (const char* always : {"f", "mount", "lever_arm"}) *v.find(always) = Value{};  // no default of theirs is taken
    return v;
  }
  if (list == "image_points") return effective(io::ImageFile{});
  if (list == "photos") return effective(io::PhotoFiles{});
  if (list == "control") return effective(io::ControlFile{});
  if (list == "points") return effective(io::PointFile{});
  return Value::object();
}

}  // namespace

std::string survey_toml(const io::Survey& survey, const std::string& comment) {
  const Value all = effective(survey);
  Value defaults = effective(io::Survey{});
  *defaults.find("scanner")->find("model") = Value{};  // stated always
  const Value out = pruned(all, defaults);
  Value ordered = Value::object();
  for (const auto& [key, v] : all.members()) {
    if (is_full(key) || (key == "antenna" && !survey.gnss.empty())) {
      if (!(v.is_array() && v.items().empty())) ordered[key] = v;
      continue;
    }
    if (const Value* kept = out.find(key)) {
      if (io::is_table_list(*kept)) {
        const Value fallback = fallback_of(key);
        ordered[key] = Value::array();
        for (const Value& item : kept->items()) ordered[key].push(pruned(item, fallback));
      } else {
        ordered[key] = *kept;
      }
    }
  }
  return comment + io::to_toml(ordered);
}

}  // namespace swath::simulate
