// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>

#include "core/picture.h"

namespace swath::io {

/// Writes a picture as PNG, 8-bit RGB. Equal pictures give equal bytes. Throws core::Error.
void write_png(const std::filesystem::path& file, const core::Picture& picture);

/// The bytes of the PNG file, for embedding (report.html). `name` stands in errors.
std::string png_bytes(const core::Picture& picture, const std::filesystem::path& name = "picture");

/// Reads any PNG as RGB (transparent parts on white). Throws core::Error.
core::Picture read_png(const std::filesystem::path& file);

}  // namespace swath::io
