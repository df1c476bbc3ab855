// SPDX-License-Identifier: GPL-3.0-or-later
// Addresses of object stores and web servers, as a survey or a command line states them.
#pragma once

#include <filesystem>
#include <string>

namespace swath::io {

/// s3://BUCKET/KEY, gs://, az://, http:// and https:// (of which a path may lose one slash), or GDAL's own names of them:
/// /vsis3/BUCKET/KEY, /vsigs/, /vsiaz/, /vsicurl/, and /vsimem/ for a file in the memory of this process. Such a name is a path of one
/// piece: it has no relative form and is not normalized.
bool is_address(const std::filesystem::path& file);

/// GDAL's name of the address: /vsis3/BUCKET/KEY. Throws core::Error for one that holds a password or a signature: it would stand in
/// reports.
std::string gdal_name(const std::filesystem::path& address);

/// Without what would give its reader access: user and password before the host, and the query of an http address (signatures, tokens),
/// also of all such addresses in a longer text. For messages.
std::string without_access(std::string text);

/// The address with both slashes of its scheme, the name of a local file as it is: for people.
std::string shown_name(const std::filesystem::path& file);

/// An address as it is, the absolute and normal name of a local file.
std::filesystem::path full_name(const std::filesystem::path& file);

}  // namespace swath::io
