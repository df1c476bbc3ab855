// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace swath::io {

/// Records that the header of a laser file states: points of LAS and LAZ, rows of NumPy arrays, pulses of Optech CSD. Nothing where the
/// file is of another format, by its first bytes. Throws core::Error where it cannot be read.
std::optional<std::uint64_t> stated_records(const std::filesystem::path& file);

}  // namespace swath::io
