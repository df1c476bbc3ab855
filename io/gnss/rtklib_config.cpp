// SPDX-License-Identifier: GPL-3.0-or-later
// RTKLIB 2.4.2 manual, appendix "Configuration file"; what 2.4.3 b34 takes was tried on the program. Values stand right behind the '=':
// RTKLIB takes blanks as part of them, and '#' begins a remark.
#include "io/gnss/rtklib_config.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "core/config/units.h"
#include "core/error.h"

namespace swath::io {
namespace {

struct SystemBit {
  std::string_view name;
  int bit;
};
constexpr std::array<SystemBit, 6> systems_known{{{"gps", 1}, {"sbas", 2}, {"glonass", 4}, {"galileo", 8}, {"qzss", 16}, {"beidou", 32}}};

const SystemBit* find_system(std::string_view name) {
  const auto* at = std::find_if(systems_known.begin(), systems_known.end(), [&](const SystemBit& s) { return s.name == name; });
  return at == systems_known.end() ? nullptr : at;
}

/// One configuration file on its way.
class Text {
 public:
  void set(std::string_view key, const std::string& value) {
    if (value.find_first_of("#\n\r") != std::string::npos)
      throw core::usage_error("RTKLIB cannot take '" + value + "' as " + std::string(key), {}, "leave out the # in it");
    text_ += std::string(key) + "=" + value + "\n";
  }
  void set(std::string_view key, const char* value) { set(key, std::string(value)); }
  void set(std::string_view key, bool on) { set(key, on ? "on" : "off"); }
  void set(std::string_view key, int value) { set(key, std::to_string(value)); }
  void set(std::string_view key, double value) { set(key, core::format_number(value)); }
  template <class E, size_t N>
  void set(std::string_view key, E choice, const std::array<const char*, N>& words) {
    set(key, words.at(static_cast<size_t>(choice)));
  }
  void antenna(const std::string& end, const RtklibAntenna& a) {
    set(end + "-anttype", a.type);
    set(end + "-antdele", a.offset.x());
    set(end + "-antdeln", a.offset.y());
    set(end + "-antdelu", a.offset.z());
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

}  // namespace

bool are_gnss_systems(const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [](const std::string& n) { return find_system(n); });
}

bool are_satellites(const std::vector<std::string>& names) {
  return std::all_of(names.begin(), names.end(), [](const std::string& name) {
    const std::string_view n = std::string_view(name).substr(name.starts_with('+') ? 1 : 0);
    return (n.size() == 3 || n.size() == 4) && std::string_view("GRECJIS").find(n[0]) != std::string_view::npos &&
           n.find_first_not_of("0123456789", 1) == std::string_view::npos;
  });
}

std::string rtklib_config(const RtklibOptions& o, const RtklibSetup& setup) {
  const bool precise = setup.precise_orbits, phase_centres = !setup.antenna_file.empty();
  int systems = 0;
  for (const std::string& name : o.systems)
    if (const SystemBit* s = find_system(name)) systems |= s->bit;
  std::string excluded;
  for (const std::string& name : o.exclude) excluded += (excluded.empty() ? "" : " ") + name;

  Text t;
  if (setup.base)
    t.set("pos1-posmode", o.mode, std::array{"kinematic", "static", "dgps"});
  else
    t.set("pos1-posmode", "single");
  t.set("pos1-frequency", std::array{"l1", "l1+2", "l1+2+3"}.at(static_cast<size_t>(o.frequencies - 1)));
  t.set("pos1-soltype", o.direction, std::array{"combined", "forward", "backward"});
  t.set("pos1-elmask", core::to_degrees(o.elevation_mask));
  t.set("pos1-dynamics", o.dynamics);
  t.set("pos1-tidecorr", "off");
  t.set("pos1-ionoopt", o.ionosphere, std::array{"off", "brdc", "dual-freq", "est-stec"});
  t.set("pos1-tropopt", o.troposphere, std::array{"off", "saas", "est-ztd", "est-ztdgrad"});
  t.set("pos1-sateph", precise ? "precise" : "brdc");
  t.set("pos1-posopt1", phase_centres && precise);  // phase centres of the satellites: broadcast orbits are of the centres themselves
  t.set("pos1-posopt2", phase_centres);
  t.set("pos1-exclsats", excluded);
  t.set("pos1-navsys", systems);
  t.set("pos2-armode", o.ambiguities, std::array{"off", "continuous", "instantaneous", "fix-and-hold"});
  t.set("pos2-gloarmode", o.fix_glonass);
  t.set("pos2-arthres", o.ratio);
  t.set("pos2-arlockcnt", o.lock);
  t.set("pos2-arelmask", core::to_degrees(o.ambiguity_elevation_mask));
  t.set("pos2-maxage", o.max_age.value);
  t.set("stats-prnaccelh", o.acceleration_horizontal.value);
  t.set("stats-prnaccelv", o.acceleration_vertical.value);
  t.set("misc-timeinterp", o.interpolate_base);
  t.antenna("ant1", setup.rover_antenna);
  if (setup.base) {
    t.set("ant2-postype", "xyz");
    t.set("ant2-pos1", setup.base->x());
    t.set("ant2-pos2", setup.base->y());
    t.set("ant2-pos3", setup.base->z());
    t.antenna("ant2", setup.base_antenna);
  }
  if (phase_centres) {
    t.set("file-rcvantfile", setup.antenna_file);
    t.set("file-satantfile", setup.antenna_file);
  }
  t.set("out-solformat", o.coordinates, std::array{"xyz", "llh"});
  t.set("out-height", "ellipsoidal");
  t.set("out-degform", "deg");
  t.set("out-outhead", true);
  t.set("out-outopt", true);
  t.set("out-outvel", false);
  t.set("out-outsingle", o.keep_single || !setup.base);
  t.set("out-timesys", "gpst");
  t.set("out-timeform", "tow");
  t.set("out-timendec", 6);
  t.set("out-fieldsep", "");
  t.set("out-outstat", "off");
  return t.take();
}

}  // namespace swath::io
