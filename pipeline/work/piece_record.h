// SPDX-License-Identifier: GPL-3.0-or-later
// A finished piece of the work folder: a record beside its files names each of them with its length and checksum, and holds a note. The
// record is written last, and has a checksum of its own: a piece is whole where its record is and every file is as it says.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/config/result.h"
#include "core/error.h"

namespace swath::pipeline {

/// A file of a piece as it was finished.
struct PieceFile {
  std::filesystem::path name;  ///< relative to the record's folder
  std::uint64_t bytes = 0;
  std::string checksum;
};

template <class V>
void describe(const PieceFile& f, V& v) {
  v.result("name", f.name, "Relative to the record's folder.");
  v.result("bytes", f.bytes, "Its length.");
  v.result("checksum", f.checksum, "XXH3 of 64 bits; empty where it was not taken.");
}

/// The file as it is now. Throws core::SystemError where it is gone or cannot be read.
PieceFile piece_file(const std::filesystem::path& folder, const std::filesystem::path& file);
/// The same for each of the files, once.
std::vector<PieceFile> piece_files(const std::filesystem::path& folder, std::vector<std::filesystem::path> files);
/// The same for files that no record names, which may be large: they are not read, and their checksums are empty.
std::vector<PieceFile> files_without_checksum(const std::filesystem::path& folder, std::vector<std::filesystem::path> files);
/// Adds the files of `by`, each in place of one of the same name, in order of names.
void replace_files(std::vector<PieceFile>& files, std::vector<PieceFile> by);

struct PieceRecord {
  std::vector<PieceFile> files;
  core::Value note;
};

/// Writes the record under `at`; `named`: the name under which it will be read, which is part of it so that another piece's record is
/// not taken for it.
void write_record(const std::filesystem::path& at, const std::filesystem::path& named, const PieceRecord& record);
inline void write_record(const std::filesystem::path& file, const PieceRecord& record) { write_record(file, file, record); }

/// Nothing where there is no record, or it is damaged or another piece's. Does not look at the files.
std::optional<PieceRecord> read_record(const std::filesystem::path& file);

/// Are all files of the record in `folder` there, plain files of the length and checksum that it says? `may_lack`: those that are there
/// are.
bool is_whole(const PieceRecord& record, const std::filesystem::path& folder, bool may_lack = false);

/// For a file of the work folder that was whole at the start of the run and is not: the next run makes it anew.
core::SystemError damaged_work(const std::filesystem::path& file);

}  // namespace swath::pipeline
