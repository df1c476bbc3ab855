// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the names of GDAL's virtual file systems (gdal.org, "GDAL Virtual File Systems").
#include "io/store/address.h"

#include <array>
#include <string_view>

namespace swath::io {
namespace {

struct Scheme {
  std::string_view stated, gdal;
  bool keeps_scheme;  ///< GDAL's name holds the whole address
};
constexpr std::array<Scheme, 5> schemes{{{"s3:/", "/vsis3/", false},
                                         {"gs:/", "/vsigs/", false},
                                         {"az:/", "/vsiaz/", false},
                                         {"https:/", "/vsicurl/", true},
                                         {"http:/", "/vsicurl/", true}}};
constexpr std::array<std::string_view, 5> gdal_systems{"/vsis3/", "/vsigs/", "/vsiaz/", "/vsicurl/", "/vsimem/"};

const Scheme* scheme_of(std::string_view name) {
  for (const Scheme& s : schemes)
    if (name.starts_with(s.stated)) return &s;
  return nullptr;
}

/// What follows the scheme and its slashes.
std::string_view behind(const Scheme& s, std::string_view name) {
  name.remove_prefix(s.stated.size());
  if (name.starts_with('/')) name.remove_prefix(1);
  return name;
}

}  // namespace

bool is_address(const std::filesystem::path& file) {
  const std::string_view name = file.native();
  if (scheme_of(name)) return true;
  for (const std::string_view s : gdal_systems)
    if (name.starts_with(s)) return true;
  return false;
}

std::string gdal_name(const std::filesystem::path& address) {
  const Scheme* s = scheme_of(address.native());
  if (!s) return address.native();
  return std::string(s->gdal) + (s->keeps_scheme ? shown_name(address) : std::string(behind(*s, address.native())));
}

std::string shown_name(const std::filesystem::path& file) {
  const Scheme* s = scheme_of(file.native());
  return s ? std::string(s->stated) + "/" + std::string(behind(*s, file.native())) : file.native();
}

std::filesystem::path full_name(const std::filesystem::path& file) {
  return is_address(file) ? file : std::filesystem::absolute(file).lexically_normal();
}

}  // namespace swath::io
