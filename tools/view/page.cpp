// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/view/page.h"

#include <functional>
#include <map>

#include "core/error.h"
#include "io/text/value_file.h"
#include "report/html.h"
#include "tools/view/pages.h"

namespace swath::tools {
namespace {

/// JSON that no script element ends in, whatever its texts hold.
std::string script_json(const core::Value& table) {
  std::string out;
  for (const char c : io::to_json(table)) c == '<' ? out += "\\u003c" : out += c;
  return out;
}

/// The template with its {{names}} replaced, once: what is put in is not looked at again.
std::string filled(const std::map<std::string_view, std::string>& parts) {
  std::string out;
  std::string_view rest = page_template;
  while (true) {
    const std::size_t open = rest.find("{{");
    if (open == std::string_view::npos) break;
    const std::size_t close = rest.find("}}", open);
    const auto part = close == std::string_view::npos ? parts.end() : parts.find(rest.substr(open + 2, close - open - 2));
    if (part == parts.end()) {
      out += rest.substr(0, open + 2);
      rest.remove_prefix(open + 2);
      continue;
    }
    out += rest.substr(0, open);
    out += part->second;
    rest.remove_prefix(close + 2);
  }
  return out += rest;
}

std::string page_of(const Scene& scene, bool served) {
  core::Value table = scene.table;
  table["served"] = served;
  std::string blobs;
  if (!served)
    for (const Blob& b : scene.blobs)
      blobs += "<script type=\"application/octet-stream\" id=\"blob-" + b.name + "\">" + report::base64(b.bytes) + "</script>\n";
  return filled({{"title", report::escaped(scene.title)},
                 {"about", report::escaped(scene.about)},
                 {"policy", std::string(served ? served_policy : saved_policy)},
                 {"report", scene.report},
                 {"scene", script_json(table)},
                 {"blobs", blobs}});
}

}  // namespace

void expect_pages() {
  if (page_template.empty())
    throw core::usage_error("this swath was built without its pages", "swath view",
                            "install Node.js 18 or newer with npm and build again (-DSWATH_PAGES=ON reports what is missing)");
}

std::string saved_page(const Scene& scene) { return page_of(scene, false); }
std::string served_page(const Scene& scene) { return page_of(scene, true); }

}  // namespace swath::tools
