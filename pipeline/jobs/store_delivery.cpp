// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/jobs/store_delivery.h"

#include <algorithm>
#include <optional>
#include <set>
#include <vector>

#include "io/store/address.h"
#include "io/store/object.h"
#include "io/text/value_file.h"
#include "pipeline/engine/survey_stages.h"
#include "pipeline/input_guard.h"
#include "pipeline/work/piece_record.h"

namespace swath::pipeline {
namespace {

namespace fs = std::filesystem;

constexpr const char *open_copies = ".swath-copies", *last_copied = "report.json";

/// Files of the output but for those whose names begin with a dot (a work folder, temporary names, our record) and the run's inputs, the
/// report last.
std::vector<fs::path> products_in(const fs::path& output, const Plan& plan) {
  std::set<fs::path> inputs;
  for (const fs::path& file : files_of(plan)) inputs.insert(fs::weakly_canonical(file));
  std::vector<fs::path> out;
  for (auto at = fs::recursive_directory_iterator(output); at != fs::recursive_directory_iterator(); ++at) {
    const bool is_hidden = at->path().filename().string().starts_with('.');
    if (at->is_directory() && is_hidden) at.disable_recursion_pending();
    if (at->is_regular_file() && !is_hidden && !inputs.contains(fs::weakly_canonical(at->path()))) out.push_back(at->path());
  }
  const fs::path report = output / last_copied;
  std::sort(out.begin(), out.end(),
            [&](const fs::path& a, const fs::path& b) { return std::pair(a == report, a) < std::pair(b == report, b); });
  return out;
}

/// The outcome of an earlier call, whose products are whole and not all copied.
std::optional<Outcome> uncopied(Plan& plan, const fs::path& output) {
  const std::optional<PieceRecord> record = read_record(output / open_copies);
  const core::Value* made = record ? record->note.find("fingerprint") : nullptr;
  const core::Value* code = record ? record->note.find("code") : nullptr;
  if (!made || !code || !is_whole(*record, output)) return std::nullopt;
  Progress quiet(Voice::quiet);
  RunState run(plan, quiet);
  prepare(run);
  if (made->as_text() != run.fingerprints.back()) return std::nullopt;
  return Outcome{static_cast<core::Exit>(code->as_int()), io::read_value_file(output / last_copied)};
}

fs::path place_below(const fs::path& store, const fs::path& name) {
  std::string text = store.native();
  while (text.ends_with('/')) text.pop_back();
  return text + "/" + name.generic_string();
}

}  // namespace

void check_store(const fs::path& store) {
  const std::string name = io::is_address(store) ? io::gdal_name(store) : "";
  const std::string place = name.substr(std::min(name.size(), name.find('/', 1)));
  if (name.empty() || name.starts_with("/vsicurl/") || place.find_first_not_of('/') == std::string::npos)
    throw core::usage_error("it is not a place in an object store that can be written", store.string(),
                            "name one as --deliver s3://BUCKET/PREFIX (gs://, az://)");
}

Outcome run_to_store(Plan& plan, Progress& progress, const std::string& command, const fs::path& store, Copied& copied) {
  check_store(store);
  const fs::path output = fs::absolute(plan.run.output), record = output / open_copies;
  std::optional<Outcome> done = uncopied(plan, output);
  copied = {0, 0, done.has_value()};
  if (!done) {
    std::error_code ignored;
    fs::remove(record, ignored);
    done = run(plan, progress, command);
    const core::Value& last = done->report.find("stages")->items().back();
    write_record(record,
                 {piece_files(output, products_in(output, plan)),
                  core::Value::Object{{"fingerprint", *last.find("fingerprint")}, {"code", static_cast<std::int64_t>(done->code)}}});
  }
  for (const fs::path& file : products_in(output, plan)) {
    copied.bytes += io::store_file(file, place_below(store, file.lexically_relative(output)),
                                   "the products are in " + plan.run.output.string() + ": the same command copies them again");
    ++copied.files;
  }
  std::error_code ignored;
  fs::remove(record, ignored);
  return std::move(*done);
}

}  // namespace swath::pipeline
