// SPDX-License-Identifier: GPL-3.0-or-later
// Source: the names of GDAL's virtual file systems (gdal.org, "GDAL Virtual File Systems").
#include "io/store/address.h"

#include <array>
#include <string_view>

#include "core/error.h"

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

std::string without_access(std::string text) {
  for (size_t at = text.find("http"); at != std::string::npos; at = text.find("http", at + 1)) {
    size_t host = text.find(":/", at);
    if (host != at + 4 && host != at + 5) continue;
    host = text.find_first_not_of('/', host + 1);
    const size_t end = std::min(text.size(), text.find_first_of(" \t\n\"'<>", at)), query = text.find('?', at);
    if (query < end) text.replace(query, end - query, "?...");
    const size_t slash = std::min(text.find('/', host), end), user = text.find('@', host);
    if (user < slash) text.erase(host, user + 1 - host);
  }
  return text;
}

std::string gdal_name(const std::filesystem::path& address) {
  if (const std::string plain = without_access(address.native()); plain != address.native())
    throw core::Error("an address with a password or a signature is not opened: it would stand in reports", plain,
                      "state the address alone, and access by GDAL's variables: docs/stores.md");
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
