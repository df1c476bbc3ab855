// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tools/view/scene.h"

namespace swath::tools {

/// Throws core::usage_error where the program was built without the page.
void expect_pages();

/// One file that holds all it shows.
std::string saved_page(const Scene& scene);
/// The same without the columns, which it asks the server for under scene/NAME.
std::string served_page(const Scene& scene);

}  // namespace swath::tools
