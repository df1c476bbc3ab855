// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace swath::core {

/// The exit codes of the program (docs/cli.md).
enum class Exit : int { done = 0, bad_data = 1, bad_usage = 2, quality_missed = 3 };

/// The one error type. Thrown at doors (files, configs); algorithms return values.
/// `what` says what is wrong, `where` names file, record, byte or key path, `hint` says what to do.
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& what, std::string where = {}, std::string hint = {}, Exit code = Exit::bad_data)
      : std::runtime_error(what), where_(std::move(where)), hint_(std::move(hint)), code_(code) {}

  const std::string& where() const { return where_; }
  const std::string& hint() const { return hint_; }
  Exit code() const { return code_; }

  /// "where: what" and the hint, on one or two lines, for a person.
  std::string text() const {
    std::string out = where_.empty() ? std::string(what()) : where_ + ": " + what();
    if (!hint_.empty()) out += "\n  hint: " + hint_;
    return out;
  }

 private:
  std::string where_;
  std::string hint_;
  Exit code_;
};

/// The machine refused (disk full, no rights): work done so far stays valid.
class SystemError : public Error {
 public:
  using Error::Error;
};

/// An error of the command line or of a config: exit code 2.
inline Error usage_error(const std::string& what, std::string where = {}, std::string hint = {}) {
  return Error(what, std::move(where), std::move(hint), Exit::bad_usage);
}

}  // namespace swath::core
