// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/engine/account.h"

#include "core/error.h"

namespace swath::pipeline {

std::optional<Account> account_of(const core::Value& note) {
  const core::Value *in = note.find("in"), *out = note.find("out"), *cut = note.find("cut"), *seconds = note.find("seconds");
  const core::Value* processor = note.find("processor_seconds");
  const core::Value *tally = note.find("tally"), *findings = note.find("findings"), *records = note.find("records");
  if (!in || !out || !cut || !seconds || !processor || !tally || !findings || !records) return std::nullopt;
  const auto count = [](const core::Value* v) { return static_cast<std::uint64_t>(v->as_int()); };
  Account a{count(in), count(out), count(cut), {seconds->as_number(), processor->as_number()}, core::Tally::from(*tally), *findings};
  for (const core::Value& r : records->items()) {
    const std::string& kind = r.find("name")->as_text();
    a.tally.read(kind, count(r.find("read")));
    if (const core::Value* kept = r.find("kept")) a.tally.keep(kind, count(kept));
  }
  return a;
}

void expect_balance(const core::Tally& tally, const stages::Stage& stage) {
  if (const std::string kind = tally.unbalanced(); !kind.empty())
    throw core::Error(kind + " of its files were lost", std::string(stage.info().name), "this is a fault of the program");
}

}  // namespace swath::pipeline
