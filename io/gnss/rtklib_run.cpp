// SPDX-License-Identifier: GPL-3.0-or-later
// The program ends with code 0 whatever comes of its work (2.4.3 b34), and reports what it did on stderr, so its log is read and its
// solution counted.
#include "io/gnss/rtklib_run.h"

#include <cerrno>
#include <fstream>

#include "core/error.h"
#include "io/gnss/rinex_header.h"
#include "io/text/output_file.h"
#include "io/text/process.h"

namespace swath::io {
namespace {

namespace fs = std::filesystem;

/// The folder that the program works in, gone at the end; what a killed run left is removed before.
class Scratch {
 public:
  explicit Scratch(fs::path folder) : path(std::move(folder)) {
    std::error_code ec;
    fs::remove_all(path, ec);
    fs::create_directories(path, ec);
    if (ec) throw_system_error("cannot make the folder", path, ec.value());
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path path;

  void link(const fs::path& file, const std::string& name) const {
    std::error_code ec;
    if (!fs::is_regular_file(file, ec)) throw_system_error("cannot open", file, ec ? ec.value() : ENOENT);
    fs::create_symlink(fs::absolute(file), path / name, ec);
    if (ec) fs::copy_file(file, path / name, ec);
    if (ec) throw_system_error("cannot link or copy into the program's folder", file, ec.value());
  }
  /// Links files as STEM_01.ENDING ...; several of one receiver are named to the program by one pattern.
  std::string link_all(const std::vector<fs::path>& files, const std::string& stem, const std::string& ending) const {
    for (size_t i = 0; i < files.size(); ++i) link(files[i], numbered(stem, i, ending));
    return files.size() == 1 ? numbered(stem, 0, ending) : stem + "_*" + ending;
  }
  static std::string numbered(const std::string& stem, size_t i, const std::string& ending) {
    char digits[24];
    std::snprintf(digits, sizeof digits, "_%03zu", i + 1);
    return stem + digits + ending;
  }
};

struct Log {
  std::string text;      ///< without lines of progress
  std::string last;      ///< the last line that says something
  std::string rejected;  ///< first complaint about the configuration
};

/// Of a log without end the first part, and its last line.
Log read_log(const fs::path& file) {
  constexpr size_t longest_line = 4096, longest_log = 1 << 20;
  Log log;
  std::ifstream in(file, std::ios::binary);
  std::string line;
  const auto take = [&] {
    while (!line.empty() && (line.back() == ' ' || line.back() == '\t')) line.pop_back();
    if (!line.empty() && !line.starts_with("processing :") && !line.starts_with("reading")) {
      if (log.text.size() < longest_log) log.text += line + "\n";
      log.last = line;
      if (log.rejected.empty() && line.starts_with("invalid option")) log.rejected = line;
    }
    line.clear();
  };
  for (char c = 0; in.get(c);) {
    if (c == '\n' || c == '\r')
      take();
    else if (line.size() < longest_line)
      line += c;
  }
  take();
  return log;
}

bool has_solution(const fs::path& pos) {
  std::ifstream in(pos, std::ios::binary);
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \r") != std::string::npos && line[0] != '%') return true;
  return false;
}

}  // namespace

fs::path run_rtklib(const RtklibJob& job) {
  const fs::path configuration = job.products / (job.name + ".conf"), log_file = job.products / (job.name + ".log"),
                 pos = job.products / (job.name + ".pos");
  const Scratch scratch(job.products / (".work-" + job.name));
  RtklibSetup setup = job.setup;
  setup.antenna_file.clear();
  if (job.antenna_file) {
    setup.antenna_file = "antennas.atx";
    scratch.link(*job.antenna_file, setup.antenna_file);
  }
  write_text_file(configuration, rtklib_config(job.options, setup));
  scratch.link(configuration, "rtklib.conf");

  std::vector<std::string> arguments = {"-k", "rtklib.conf", "-o", "solution.pos"};
  if (job.every > 0) arguments.insert(arguments.end(), {"-ti", core::format_number(job.every)});
  arguments.push_back(scratch.link_all(job.rover, "rover", ".obs"));
  if (!job.base.empty()) arguments.push_back(scratch.link_all(job.base, "base", ".obs"));
  for (size_t i = 0; i < job.navigation.size(); ++i) {
    const bool orbits = rinex_kind(job.navigation[i]) == RinexKind::orbits;
    const std::string name = Scratch::numbered("navigation", i, orbits ? ".sp3" : ".nav");
    scratch.link(job.navigation[i], name);
    arguments.push_back(name);
  }
  const ProcessEnd end = run_program(job.program, arguments, scratch.path, scratch.path / "log", job.time_limit);
  const Log log = read_log(scratch.path / "log");
  std::string command = job.program.string();
  for (const std::string& a : arguments) command += " " + a;
  write_text_file(log_file, command + "\n" + log.text + end.text() + "\n");

  const std::string last_line = log.last.empty() ? "" : "; it says: " + log.last;
  if (end.too_long)
    throw core::Error("rnx2rtkp took longer than " + core::format_number(job.time_limit) + " s and was ended" + last_line,
                      log_file.string(), "raise time_limit of gnss.rtklib, or split the observations");
  if (!end.well())
    throw core::Error("rnx2rtkp failed with " + end.text() + last_line, log_file.string(),
                      end.signal ? "run the command in the log by hand; another version of RTKLIB may do better" : "");
  if (!log.rejected.empty())
    throw core::Error("rnx2rtkp does not know a value of its configuration: " + log.rejected, configuration.string(),
                      "the configuration is written for RTKLIB 2.4.2 and 2.4.3");
  if (!has_solution(scratch.path / "solution.pos"))
    throw core::Error("rnx2rtkp found no solution for " + job.name + last_line, log_file.string(),
                      "do the navigation files cover the day and the satellite systems? is the base's position that of its marker, and "
                      "do both receivers record carrier phases (mode = \"dgps\" needs code alone)?");
  std::error_code ec;
  OutputFile out(pos);
  fs::copy_file(scratch.path / "solution.pos", out.temporary(), fs::copy_options::overwrite_existing, ec);
  if (ec) throw_system_error("cannot write", pos, ec.value());
  out.commit();
  return pos;
}

}  // namespace swath::io
