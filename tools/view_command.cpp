// SPDX-License-Identifier: GPL-3.0-or-later
// Products in a browser: one file, or a server on this machine.
#include <algorithm>
#include <cstdio>

#include "core/error.h"
#include "io/copc/copc_hierarchy.h"
#include "io/text/output_file.h"
#include "pipeline/input_guard.h"
#include "tools/command.h"
#include "tools/view/page.h"
#include "tools/view/scene.h"
#include "tools/view/server.h"

namespace swath::tools {
namespace {

struct ViewArguments {
  std::vector<std::filesystem::path> given;
  std::filesystem::path save;
  std::uint64_t points = 0;
  int port = 0;
  Loudness loudness;
};

constexpr std::uint64_t saved_points = 1000000, served_points = 3000000, first_points = 100000;

Scene scene_of(const ViewArguments& a, const ProductFiles& files, const SceneOptions& options) {
  pipeline::Progress progress(a.loudness.voice());
  progress.begin("view", 0, "");
  Scene scene = make_scene(files, options, [&](double share, std::string_view) { progress.share(share); });
  progress.end();
  return scene;
}

int save(const ViewArguments& a, const ProductFiles& files) {
  std::vector<std::filesystem::path> read = files.clouds;
  read.insert(read.end(), {files.terrain, files.contours, files.trajectory, files.report});
  std::erase(read, std::filesystem::path());
  pipeline::InputGuard(read).expect_apart(a.save);
  const Scene scene = scene_of(a, files, {.points = a.points > 0 ? a.points : saved_points});
  const std::string page = saved_page(scene);
  io::write_text_file(a.save, page);
  if (!a.loudness.quiet) {
    char size[32];
    std::snprintf(size, sizeof size, "%.1f MB", 1e-6 * static_cast<double>(page.size()));
    print(a.save.string() + ": " + scene.about + ", " + size + "\n");
  }
  return 0;
}

bool is_copc(const std::filesystem::path& file) {
  std::vector<std::string> ignored;
  return io::copc_info(io::read_las_header(file, ignored), file).has_value();
}

/// COPC files are read by the page as it needs them; it opens on a small part of their points. Of others it gets a part, once.
int serve_scene(const ViewArguments& a, const ProductFiles& files) {
  const bool streams = !files.clouds.empty() && std::all_of(files.clouds.begin(), files.clouds.end(), is_copc);
  SceneOptions options{
      .points = streams ? first_points : served_points, .terrain_side = 2048, .line_vertices = 1500000, .streams = streams};
  if (!streams && a.points > 0) options.points = a.points;
  std::string about;
  const auto prepare = [&] {
    Scene scene = scene_of(a, files, options);
    Served served;
    if (streams) {
      served.clouds = files.clouds;
      scene.table["budget"] = a.points > 0 ? a.points : served_points;
      for (std::size_t k = 0; k < files.clouds.size(); ++k) scene.table["copc"].push("cloud/" + std::to_string(k));
    }
    about = scene.about;
    served.page = served_page(scene);
    served.blobs = std::move(scene.blobs);
    served.folder = files.folder;
    return served;
  };
  serve(a.port, prepare, [&](const std::string& address) {
    if (!a.loudness.quiet) print(about + "\n");
    print("open " + address + " in a browser on this machine; Ctrl-C ends\n");
    std::fflush(stdout);
  });
  return 0;
}

int view(const ViewArguments& a) {
  expect_pages();
  if (!a.save.empty() && a.port != 0) throw core::usage_error("--port and --save exclude each other", "swath view", "leave one out");
  const ProductFiles files = products_of(a.given);
  return a.save.empty() ? serve_scene(a, files) : save(a, files);
}

}  // namespace

void add_view_command(Commands& commands) {
  const auto a = std::make_shared<ViewArguments>();
  auto* c = commands.add("view",
                         "Examples\n  swath view out\n  swath view out --save view.html\n  swath view flight.laz --save view.html --points "
                         "500000\n\nProducts of a run, or clouds, in a browser: served on this machine, or as one file to hand on.",
                         [a] { return view(*a); });
  c->add_option("OUT", a->given, "Output folder of a run, or LAS, LAZ or COPC files and folders of them")->required();
  c->add_option("--save", a->save, "Write one file that opens by double click, and serve nothing");
  c->add_option("--points", a->points, "About as many points at most; without it 1 000 000 in a file, 3 000 000 served")
      ->check(CLI::Range(std::uint64_t{1000}, std::uint64_t{20000000}));
  c->add_option("--port", a->port, "Port to serve on; without it any that is free")->check(CLI::Range(1, 65535));
  add_quiet(*c, a->loudness.quiet);
}

}  // namespace swath::tools
