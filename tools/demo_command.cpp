// SPDX-License-Identifier: GPL-3.0-or-later
// A survey from nothing to products: simulated, run, judged against its truth.
#include <cstdio>

#include "pipeline/jobs/config_folder.h"
#include "tools/command.h"

namespace swath::tools {
namespace {

struct Given {
  pipeline::Request request;
  std::vector<std::string> simulation;
  std::filesystem::path folder = "swath-demo", save;
  Loudness loudness;
};

int demo(Given a, const std::string& typed) {
  const std::filesystem::path survey = a.folder / "survey", products = a.folder / "products";
  a.request.config = "survey";
  pipeline::find_config(a.request.config);  // before the work
  make_survey({}, a.simulation, survey, a.loudness);
  a.request.survey = survey / "survey.toml";
  a.request.output = products;
  const int code = run_pipeline(a.request, a.loudness, typed, a.save);
  if (a.loudness.quiet || a.loudness.json_log) return code;
  print("\nrecords   " + survey.string() + "\nproducts  " + products.string() + "\npicture   " + (products / "relief.png").string() +
        "\n\nnext: swath view " + products.string() + "\n      swath run survey --survey " + (survey / "survey.toml").string() +
        " --output again --set dtm.cell=50cm\n");
  return code;
}

}  // namespace

void add_demo_command(Commands& commands) {
  const auto a = std::make_shared<Given>();
  auto* c =
      commands.add("demo",
                   "Examples\n  swath demo\n  swath demo --output first --set world.scene=forest\n\nSimulate a survey, make its products, "
                   "and show the errors against its truth.",
                   [a, &commands] { return demo(*a, commands.typed()); });
  add_output(*c, a->folder, "Folder to make: survey/ with the records, products/")->capture_default_str();
  c->add_option("--set", a->simulation, "One option of the simulation: seed=7, world.scene=forest")->allow_extra_args(false);
  add_run_options(*c, a->request, a->loudness, a->save);
}

}  // namespace swath::tools
