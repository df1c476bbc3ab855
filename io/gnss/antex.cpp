// SPDX-License-Identifier: GPL-3.0-or-later
// ANTEX 1.4 (Rothacher and Schmid 2010): TYPE / SERIAL NO holds the antenna in 15 columns, a blank and its radome in 4.
#include "io/gnss/antex.h"

#include <algorithm>
#include <cerrno>
#include <fstream>

#include "core/config/value.h"
#include "core/error.h"
#include "io/text/output_file.h"

namespace swath::io {
namespace {

std::string trimmed(const std::string& text) {
  const size_t first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? std::string{} : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

struct Name {
  std::string antenna, radome;
};

Name split(const std::string& type) {
  const size_t blank = type.find_first_of(" \t");
  if (blank == std::string::npos) return {type, "NONE"};
  const std::string radome = trimmed(type.substr(blank));
  return {type.substr(0, blank), radome.empty() ? "NONE" : radome};
}

}  // namespace

std::vector<std::string> antex_types(const std::filesystem::path& file) {
  if (std::filesystem::is_directory(file)) throw core::Error("is a folder, not a file", file.string());
  std::ifstream in(file, std::ios::binary);
  if (!in) throw_system_error("cannot open", file, errno);
  std::vector<std::string> out;
  std::string line;
  bool first = true;
  while (std::getline(in, line)) {
    const std::string label = line.size() > 60 ? trimmed(line.substr(60)) : std::string{};
    if (first && label != "ANTEX VERSION / SYST") throw core::Error("is no ANTEX file", file.string() + ":1");
    first = false;
    if (label != "TYPE / SERIAL NO") continue;
    const std::string type = trimmed(line.substr(0, 20)), serial = trimmed(line.substr(20, 20));
    // Satellites: the second field is a satellite's number, "G05".
    const bool satellite = serial.size() == 3 && serial.find_first_not_of("0123456789", 1) == std::string::npos && line[20] >= 'A';
    if (!type.empty() && !satellite) out.push_back(type);
  }
  if (out.empty()) throw core::Error("describes no receiver antenna", file.string());
  return out;
}

std::string find_antenna(const std::vector<std::string>& types, const std::string& type, const std::filesystem::path& file) {
  const Name wanted = split(trimmed(type));
  const auto find = [&](const std::string& radome) {
    return std::find_if(types.begin(), types.end(), [&](const std::string& t) {
      const Name n = split(t);
      return n.antenna == wanted.antenna && n.radome == radome;
    });
  };
  for (const std::string& radome : {wanted.radome, std::string("NONE")})
    if (const auto at = find(radome); at != types.end()) return *at;
  const std::string near = core::nearest(trimmed(type), types);
  throw core::Error("the antenna '" + trimmed(type) + "' is not in this file", file.string(),
                    near.empty() ? "antenna types are written as in the file, \"TRM41249.00     NONE\"" : "did you mean '" + near + "'?");
}

}  // namespace swath::io
