// SPDX-License-Identifier: GPL-3.0-or-later
// A first survey.toml from the files of a folder.
#include <algorithm>
#include <cstdio>

#include "core/error.h"
#include "io/survey/proposal.h"
#include "io/text/output_file.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct Given {
  std::filesystem::path folder;
  bool print_only = false;
  Loudness loudness;
};

int init(const Given& a) {
  const std::filesystem::path file = a.folder / "survey.toml";
  if (!a.print_only && std::filesystem::exists(file))
    throw core::usage_error("is there already", file.string(), "--print shows the proposal and writes nothing");
  if (std::filesystem::exists(a.folder) && !std::filesystem::is_directory(a.folder))
    throw core::usage_error("is a file, and a folder of a survey's files is needed", a.folder.string(),
                            "see `swath info` for what one file holds");
  pipeline::Progress progress(a.loudness.voice());
  bool begun = false;
  const auto found = io::find_records(a.folder, [&](std::size_t done, std::size_t all, const std::filesystem::path&) {
    if (!std::exchange(begun, true)) progress.begin("files", all, "files");
    if (done > 0) progress.advance(1);
  });
  if (begun) progress.advance(1), progress.end();
  const std::filesystem::path whole = std::filesystem::absolute(a.folder / ".").lexically_normal().parent_path();
  const io::Proposal proposal = io::propose_survey(found, whole.filename().string());
  if (a.print_only) return print(proposal.toml), 0;
  if (found.empty()) throw core::Error("the folder holds no file", a.folder.string(), "name the folder of a survey's records");
  if (proposal.files == 0)
    throw core::Error(found.size() == 1 ? "its only file is not a record of a survey"
                                        : "none of its " + std::to_string(found.size()) + " files is a record of a survey",
                      a.folder.string(), "--print shows what each of them is");
  io::write_text_file(file, proposal.toml);
  if (a.loudness.quiet) return 0;
  print("written: " + file.string() + ", with " + std::to_string(proposal.files) + " of " + core::counted(found.size(), "file") + "\n");
  if (!proposal.open.empty()) print("to be stated, in lines that begin with # ?\n");
  for (const std::string& one : proposal.open) print("  " + one + "\n");
  print("then: swath check " + proposal.config + " --survey " + file.string() + "\n");
  return 0;
}

}  // namespace

void add_init_command(Commands& commands) {
  const auto a = std::make_shared<Given>();
  auto* c = commands.add(
      "init", "Examples\n  swath init flight/\n  swath init flight/ --print\n\nPropose a survey.toml from the files of a folder.",
      [a] { return init(*a); });
  c->add_option("FOLDER", a->folder, "Folder of the survey's files; survey.toml is written there")->required();
  c->add_flag("--print", a->print_only, "Print the proposal and write nothing");
  add_quiet(*c, a->loudness.quiet);
}

}  // namespace swath::tools
