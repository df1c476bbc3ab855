// SPDX-License-Identifier: GPL-3.0-or-later
// What the program itself has: stages, warnings, schema, generated pages, completion, manual.
#include <cstdio>

#include "core/error.h"
#include "pipeline/describe.h"
#include "pipeline/provenance.h"
#include "tools/command.h"
#include "tools/command_docs.h"

namespace swath::tools {

void add_list_commands(Commands& commands) {
  const auto name = std::make_shared<std::string>();
  auto* c = commands.add("stages", "Examples\n  swath stages\n  swath stages filters.smrf\n\nList the stages, or describe one.", [name] {
    std::fputs(name->empty() ? pipeline::stage_list().c_str() : pipeline::stage_help(*name).c_str(), stdout);
    return 0;
  });
  c->add_option("NAME", *name, "Stage");

  const auto code = std::make_shared<std::string>();
  c = commands.add("warnings", "Examples\n  swath warnings\n  swath warnings limit.voids\n\nList the codes of warnings, or explain one.",
                   [code] {
                     print(pipeline::warning_help(*code));
                     return 0;
                   });
  c->add_option("CODE", *code, "Code of a warning");

  commands.add("schema", "Examples\n  swath schema > swath.schema.json\n\nPrint the JSON Schema of pipelines and surveys.", [] {
    print_json(pipeline::schema());
    return 0;
  });
}

void add_completion_commands(Commands& commands) {
  const auto shell = std::make_shared<std::string>();
  auto* c =
      commands.add("completion",
                   "Examples\n  swath completion bash > ~/.local/share/bash-completion/completions/swath\n  swath completion zsh > "
                   "~/.zfunc/_swath\n  swath completion fish > ~/.config/fish/completions/swath.fish\n\nPrint the completion of commands, "
                   "options and stages for a shell.",
                   [shell, &commands] {
                     const auto texts = texts_of(commands.parser());
                     const auto write = *shell == "bash" ? bash_completion : *shell == "zsh" ? zsh_completion : fish_completion;
                     std::fputs(write(texts, known_words()).c_str(), stdout);
                     return 0;
                   });
  c->add_option("SHELL", *shell, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));

  commands.add("man", "Examples\n  swath man > swath.1\n\nPrint the manual page.", [&commands] {
    std::fputs(manual_page(texts_of(commands.parser()), std::string(pipeline::program_version()), commands.parser().get_footer()).c_str(),
               stdout);
    return 0;
  });
}

void add_docs_command(Commands& commands) {
  struct Given {
    std::string folder;
    bool check = false;
  };
  const auto a = std::make_shared<Given>();
  auto* c = commands.add(
      "docs", "Examples\n  swath docs docs\n  swath docs docs --check\n\nWrite the generated parts of the documentation's pages.", [a] {
        const auto differing = pipeline::write_docs(a->folder, a->check);
        for (const auto& page : differing) std::printf("%s %s\n", a->check ? "out of date:" : "written:", page.c_str());
        return a->check && !differing.empty() ? static_cast<int>(core::Exit::bad_data) : 0;
      });
  c->add_option("FOLDER", a->folder, "The docs folder")->required();
  c->add_flag("--check", a->check, "Write nothing; exit 1 where a page is out of date");
}

}  // namespace swath::tools
