// SPDX-License-Identifier: GPL-3.0-or-later
// PROJ's objects with their owners, for the sources that call PROJ alone: no other header shows it.
#pragma once

#include <proj.h>

#include <memory>
#include <string>

#include "core/geo/crs_facts.h"

namespace swath::core {

struct ContextEnd {
  void operator()(PJ_CONTEXT* c) const { proj_context_destroy(c); }
};
struct PjEnd {
  void operator()(PJ* p) const { proj_destroy(p); }
};
struct PjListEnd {
  void operator()(PJ_OBJ_LIST* l) const { proj_list_destroy(l); }
};
struct PjFactoryEnd {
  void operator()(PJ_OPERATION_FACTORY_CONTEXT* f) const { proj_operation_factory_context_destroy(f); }
};
using ProjContext = std::unique_ptr<PJ_CONTEXT, ContextEnd>;
using Pj = std::unique_ptr<PJ, PjEnd>;
using PjList = std::unique_ptr<PJ_OBJ_LIST, PjListEnd>;
using PjFactory = std::unique_ptr<PJ_OPERATION_FACTORY_CONTEXT, PjFactoryEnd>;

/// Log and network are off.
ProjContext new_proj_context();
/// The reason of the context's last failure; empty where PROJ has no more to say than "Unknown error (code 4096)".
std::string proj_reason(PJ_CONTEXT* c);
/// Empty for nullptr.
std::string proj_text(const char* t);
/// Null where PROJ does not understand the definition.
Pj parse_crs(PJ_CONTEXT* c, const std::string& definition);
/// A CRS without a vertical part gets ellipsoidal heights in metres as its third axis, or PROJ would drop them. Null as parse_crs().
Pj three_dimensional(PJ_CONTEXT* c, const CrsFacts& crs);
/// At most 80 characters of a definition, for messages.
std::string short_form(const std::string& definition);

}  // namespace swath::core
