// SPDX-License-Identifier: GPL-3.0-or-later
// What is made from a struct's describe(): reading a config, its effective values, its documentation, its JSON Schema.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/config/option.h"
#include "core/error.h"

namespace swath::core {

/// One thing wrong with a config.
struct Fault {
  Location where;
  std::string key;   ///< dotted path, "stage[2].cell"
  std::string what;  ///< value, unit, allowed range
  std::string hint;  ///< nearest known key and the like, or ""

  std::string text() const;
};

/// Something to be visited: usually [&](Visitor& v) { describe(options, v); }.
using Describe = std::function<void(Visitor&)>;

/// A Describe of one struct.
template <Described S>
Describe described(S& options) {
  return [&options](Visitor& v) { describe(options, v); };
}

/// Sets the struct's options from `table`, collecting every fault; keys in `also_known` are passed over.
/// Conditions between options are checked only where no option of that struct was at fault.
void read_options(const Describe& d, const Value& table, const std::string& path, std::vector<Fault>& faults,
                  const std::vector<std::string>& also_known = {});

/// All faults as one error (exit code 2), or nothing where there is none.
void throw_if_any(const std::vector<Fault>& faults);

/// The effective values as a table a config could hold. Options without a value are left out.
Value effective_values(const Describe& d);

/// One option as documentation shows it.
struct OptionDoc {
  std::string path;      ///< "cell", "scanner.model", "line[].first"
  std::string shape;     ///< "length", "3 angles" ...
  std::string fallback;  ///< the default, as a config would write it; "" where there is none
  std::string range;     ///< "> 0 m", "" where any
  std::string doc;
  std::string source;
  bool is_table = false;
};
std::vector<OptionDoc> document_options(const Describe& d);

/// The option table of a docs page, GitHub Markdown; and the same for a terminal.
std::string option_table_markdown(const Describe& d);
std::string option_table_text(const Describe& d);

/// JSON Schema (2020-12) of the struct's table.
Value schema_of(const Describe& d);

/// 16 hex digits that change when any effective value changes (64-bit FNV-1a of the effective values).
std::string fingerprint_of(const Describe& d);

/// FNV-1a, 64 bit: the project's hash for fingerprints. `seed` chains calls.
std::uint64_t fnv1a(std::string_view bytes, std::uint64_t seed = 0xcbf29ce484222325ULL);

/// 16 hex digits.
std::string hex(std::uint64_t v);

}  // namespace swath::core
