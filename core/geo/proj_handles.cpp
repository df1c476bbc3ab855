// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/geo/proj_handles.h"

#include <proj_experimental.h>  // proj_crs_promote_to_3D

namespace swath::core {

ProjContext new_proj_context() {
  ProjContext c(proj_context_create());
  proj_log_level(c.get(), PJ_LOG_NONE);
  proj_context_set_enable_network(c.get(), 0);
  return c;
}

std::string proj_text(const char* t) { return t ? t : ""; }

std::string proj_reason(PJ_CONTEXT* c) {
  std::string reason = proj_text(proj_context_errno_string(c, proj_context_errno(c)));
  return reason.starts_with("Unknown error") ? std::string() : reason;
}

std::string short_form(const std::string& definition) { return definition.size() <= 80 ? definition : definition.substr(0, 77) + "..."; }

Pj parse_crs(PJ_CONTEXT* c, const std::string& definition) { return Pj(proj_create(c, definition.c_str())); }

Pj three_dimensional(PJ_CONTEXT* c, const CrsFacts& crs) {
  Pj plain = parse_crs(c, crs.definition);
  if (!plain || crs.vertical || crs.geocentric) return plain;
  Pj promoted(proj_crs_promote_to_3D(c, nullptr, plain.get()));
  return promoted ? std::move(promoted) : std::move(plain);
}

}  // namespace swath::core
