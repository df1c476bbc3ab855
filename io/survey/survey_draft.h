// SPDX-License-Identifier: GPL-3.0-or-later
// The text of a survey.toml while it is proposed.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/config/value.h"
#include "io/text/toml_text.h"

namespace swath::io {

/// The survey while it is written.
class SurveyDraft {
 public:
  void list(const std::string& name, const std::filesystem::path& file) {
    list(name);
    ++files_;
    known("file", file.generic_string());
  }
  void list(const std::string& name) {
    table_ = name + "[" + std::to_string(++tables_[name]) + "]";
    text_ += "\n[[" + name + "]]\n";
  }
  void table(const std::string& name) {
    table_ = name;
    text_ += "\n[" + name + "]\n";
  }
  void known(const std::string& key, const core::Value& value) { line(key + " = " + toml_scalar(value)); }
  void line(const std::string& text) { text_ += text + "\n"; }
  /// A line to be completed, and why it is not known.
  void open(const std::string& line, const std::string& why) {
    text_ += "# ? " + why + "\n# " + line + "\n";
    const std::string key = line.substr(0, line.find(" = "));
    open_.push_back((table_.empty() ? key : table_ + "." + key) + ": " + why);
  }
  /// What a person has to judge where no line is to be completed.
  void doubt(const std::string& key, const std::string& why) {
    note("? " + why);
    open_.push_back(table_ + "." + key + ": " + why);
  }
  void note(const std::string& text) { text_ += (text.starts_with("\n") ? "" : "# ") + text + "\n"; }
  void count_file() { ++files_; }
  const std::string& text() const { return text_; }
  std::size_t files() const { return files_; }
  const std::vector<std::string>& questions() const { return open_; }

 private:
  std::string text_, table_;
  std::map<std::string, int> tables_;
  std::size_t files_ = 0;
  std::vector<std::string> open_;
};

}  // namespace swath::io
