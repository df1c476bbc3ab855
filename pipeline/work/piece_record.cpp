// SPDX-License-Identifier: GPL-3.0-or-later
// Format: JSON, a line feed, "xxh3 ", the checksum of what precedes it, a line feed.
#include "pipeline/work/piece_record.h"

#include <algorithm>
#include <map>

#include "core/config/result_visitors.h"
#include "io/text/output_file.h"
#include "io/text/value_file.h"
#include "pipeline/work/checksum.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;
using core::Value;

constexpr std::string_view seal = "\nxxh3 ";

/// "03-strips-0123456789abcdef/strip_0001/strip.json": names a piece of a work folder.
std::string identity_of(const fs::path& file) {
  const fs::path folder = file.parent_path();
  return (folder.parent_path().filename() / folder.filename() / file.filename()).generic_string();
}

bool stays_within(const fs::path& name) {
  return !name.empty() && name.is_relative() && std::find(name.begin(), name.end(), "..") == name.end();
}

/// A record as its file holds it.
struct Sealed {
  std::string piece;
  const PieceRecord& record;
};

template <class V>
void describe(const Sealed& s, V& v) {
  v.result("piece", s.piece, "Which piece this is the record of.");
  v.tables("files", s.record.files, "Its files.");
  v.other("note", s.record.note, "What the run says of it.");
}

bool is_file(const Value& v) {
  const Value *name = v.find("name"), *bytes = v.find("bytes"), *checksum = v.find("checksum");
  return name && bytes && checksum && name->is_text() && bytes->is_int() && checksum->is_text();
}

std::vector<fs::path> once(std::vector<fs::path> files) {
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

/// Of a file that was finished: one that is gone was removed by others, and a record that left it out would call the piece whole.
std::uint64_t bytes_of(const fs::path& file) {
  std::error_code ec;
  const std::uint64_t bytes = fs::file_size(file, ec);
  if (ec) throw damaged_work(file);
  return bytes;
}

/// The text before the seal; nothing where it is not the one that was written.
std::optional<std::string> sealed_text(const fs::path& file) {
  std::error_code ec;
  if (!fs::is_regular_file(fs::symlink_status(file, ec))) return std::nullopt;
  std::string text = io::read_text_file(file);
  const size_t at = text.rfind(seal);
  if (at == std::string::npos) return std::nullopt;
  const std::string sum = text.substr(at + seal.size());
  text.resize(at);
  if (sum != checksum_of(text) + "\n") return std::nullopt;
  return text;
}

}  // namespace

PieceFile piece_file(const fs::path& folder, const fs::path& file) {
  return {file.lexically_relative(folder), bytes_of(file), checksum_of_file(file)};
}

std::vector<PieceFile> piece_files(const fs::path& folder, std::vector<fs::path> files) {
  std::vector<PieceFile> out;
  for (const fs::path& f : once(std::move(files))) out.push_back(piece_file(folder, f));
  return out;
}

std::vector<PieceFile> files_without_checksum(const fs::path& folder, std::vector<fs::path> files) {
  std::vector<PieceFile> out;
  for (const fs::path& f : once(std::move(files))) out.push_back({f.lexically_relative(folder), bytes_of(f), {}});
  return out;
}

void replace_files(std::vector<PieceFile>& files, std::vector<PieceFile> by) {
  std::map<fs::path, PieceFile> named;
  for (std::vector<PieceFile>* of : {&files, &by})
    for (PieceFile& f : *of) {
      fs::path name = f.name;
      named.insert_or_assign(std::move(name), std::move(f));
    }
  files.clear();
  for (auto& [name, f] : named) files.push_back(std::move(f));
}

void write_record(const fs::path& at, const fs::path& named, const PieceRecord& record) {
  std::string text = io::to_json(core::reported(Sealed{identity_of(named), record}));
  const std::string sum = checksum_of(text);
  io::write_text_file(at, text.append(seal) + sum + "\n");
}

std::optional<PieceRecord> read_record(const fs::path& file) {
  const std::optional<std::string> text = sealed_text(file);
  if (!text) return std::nullopt;
  Value all = io::parse_json(*text, file.string());
  const Value* piece = all.find("piece");
  const Value* files = all.find("files");
  Value* note = all.find("note");
  if (!piece || !files || !piece->is_text() || piece->as_text() != identity_of(file)) return std::nullopt;
  if (!files->is_array() || !std::all_of(files->items().begin(), files->items().end(), is_file)) return std::nullopt;
  PieceRecord out;
  for (const Value& one : files->items()) {
    out.files.push_back(
        {one.find("name")->as_text(), static_cast<std::uint64_t>(one.find("bytes")->as_int()), one.find("checksum")->as_text()});
    if (!stays_within(out.files.back().name)) return std::nullopt;
  }
  if (note) out.note = std::move(*note);
  return out;
}

bool is_whole(const PieceRecord& record, const fs::path& folder, bool may_lack) {
  return std::all_of(record.files.begin(), record.files.end(), [&](const PieceFile& f) {
    const fs::path file = folder / f.name;
    std::error_code ec;
    if (may_lack && !fs::exists(fs::symlink_status(file, ec))) return true;
    if (!fs::is_regular_file(fs::symlink_status(file, ec)) || fs::file_size(file, ec) != f.bytes || ec) return false;
    return checksum_of_file(file) == f.checksum;
  });
}

core::SystemError damaged_work(const fs::path& file) {
  return core::SystemError("the work of an earlier stage was changed or damaged while the run was at work", file.string(),
                           "run the same command again: what is damaged is made anew, what is whole is kept");
}

}  // namespace swath::pipeline
