// SPDX-License-Identifier: GPL-3.0-or-later
// Warnings of a run as values: a code that can be looked up (`swath warnings CODE`), figures, and a sentence made from them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/config/result.h"

namespace swath::pipeline {

/// What a code stands for.
struct WarningKind {
  std::string_view code, meaning, remedy;
};
/// Every kind, by code.
const std::vector<WarningKind>& warning_kinds();
/// What `swath warnings CODE` prints; all codes where `code` is empty. Throws core::Error (usage) for one that is not known.
std::string warning_help(const std::string& code);
/// The generated part of docs/warnings.md.
std::string warning_page();

struct WarningFigure {
  std::string_view name;
  double value = 0.0;
  std::string_view unit;
};

template <class V>
void describe(const WarningFigure& f, V& v) {
  v.result("name", f.name, "What it is.");
  v.result("value", f.value, core::plain().always(), "Its value.");
  v.result("unit", f.unit, core::plain().only_if(!f.unit.empty()), "Its unit.");
}

struct Warning {
  std::string code;
  std::string text;
  std::vector<WarningFigure> figures;
};

template <class V>
void describe(const Warning& w, V& v) {
  v.result("code", w.code, "What `swath warnings` explains.");
  v.result("text", w.text, "The sentence.");
  v.tables("figures", w.figures, "The figures in it.");
}

}  // namespace swath::pipeline
