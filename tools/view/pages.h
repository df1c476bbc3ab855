// SPDX-License-Identifier: GPL-3.0-or-later
// The page as web/build.mjs has bundled it; empty where the program was built without (SWATH_PAGES).
#pragma once

#include <string_view>

namespace swath::tools {

/// HTML with {{title}}, {{about}}, {{policy}}, {{report}}, {{scene}} and {{blobs}} to be put in place.
extern const std::string_view page_template;
/// Content security policies: of a page that asks nobody for anything, and of one that asks the server it came from.
extern const std::string_view saved_policy, served_policy;
/// The script of its worker, which reads COPC files from the server.
extern const std::string_view stream_script;

}  // namespace swath::tools
