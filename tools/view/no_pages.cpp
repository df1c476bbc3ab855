// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/pages.h"

namespace swath::tools {

const std::string_view page_template, stream_script, saved_policy, served_policy;

}  // namespace swath::tools
