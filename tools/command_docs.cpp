// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/command_docs.h"

#include <algorithm>

#include "pipeline/describe.h"
#include "pipeline/jobs/config_folder.h"
#include "pipeline/warnings.h"

namespace swath::tools {
namespace {

OptionText text_of(const CLI::Option* o) {
  OptionText out;
  out.positional = o->get_positional();
  out.help = o->get_description();
  out.takes_value = o->get_items_expected_max() != 0;  // CLI11 gives flags a type of size 1, too
  out.is_required = o->get_required();
  out.is_repeated = o->get_expected_max() > 1;
  if (out.positional) {
    out.names.push_back(o->get_name(true));
    return out;
  }
  for (const std::string& name : o->get_snames()) out.names.push_back("-" + name);
  for (const std::string& name : o->get_lnames()) out.names.push_back("--" + name);
  return out;
}

std::string joined(const std::vector<std::string>& words, const std::string& between = " ", const std::string& behind = "") {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : between) + word + behind;
  return out;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
  return text;
}

bool has_name(const OptionText& o, const std::string& name) { return std::find(o.names.begin(), o.names.end(), name) != o.names.end(); }

/// The words that a positional argument or an option takes; nothing where it takes files or anything.
const std::vector<std::string>* words_for(const CommandText& c, const OptionText& o, const Words& words) {
  static const std::vector<std::string> shells{"bash", "zsh", "fish"};
  if (has_name(o, "CONFIG")) return &words.configs;
  if (has_name(o, "NAME") && c.name == "stages") return &words.stages;
  if (has_name(o, "CODE")) return &words.warnings;
  if (has_name(o, "SHELL")) return &shells;
  // What simulate, plan and demo set are options of the simulation and of the flight, not of stages.
  const bool has_stages = c.name != "simulate" && c.name != "plan" && c.name != "demo";
  return has_name(o, "--set") && has_stages ? &words.sets : nullptr;
}

/// For single quotes of a shell.
std::string in_quotes(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

/// Help within [..] of a zsh specification.
std::string in_brackets(const std::string& text) {
  return replaced(replaced(replaced(replaced(text, "\\", "\\\\"), "[", "\\["), "]", "\\]"), ":", "\\:");
}

}  // namespace

std::vector<CommandText> texts_of(const CLI::App& app) {
  std::vector<CommandText> out;
  for (const CLI::App* c : app.get_subcommands([](const CLI::App*) { return true; })) {
    CommandText& text = out.emplace_back();
    text.name = c->get_name();
    const std::string whole = c->get_description();
    const size_t blank = whole.rfind("\n\n");
    text.sentence = blank == std::string::npos ? whole : whole.substr(blank + 2);
    if (blank != std::string::npos && whole.starts_with("Examples\n")) text.examples = whole.substr(9, blank - 9);
    for (const CLI::Option* o : c->get_options()) text.options.push_back(text_of(o));
  }
  return out;
}

Words known_words() {
  Words out{{}, pipeline::stage_names(), {}, pipeline::config_names()};
  for (const std::string& option : pipeline::settable_options()) out.sets.push_back(option + "=");
  for (const pipeline::WarningKind& kind : pipeline::warning_kinds()) out.warnings.emplace_back(kind.code);
  return out;
}

std::string bash_completion(const std::vector<CommandText>& commands, const Words& words) {
  std::string names, cases;
  for (const CommandText& c : commands) {
    names += (names.empty() ? "" : " ") + c.name;
    std::string options, values, positional;
    for (const OptionText& o : c.options) {
      const std::vector<std::string>* list = words_for(c, o, words);
      if (!o.positional) options += (options.empty() ? "" : " ") + joined(o.names);
      if (!o.positional && o.takes_value)
        values += "        " + joined(o.names, "|") + ") words=" + in_quotes(list ? joined(*list) : "") + " value=1 ;;\n";
      if (o.positional && list) positional = joined(*list);
    }
    cases += "    " + c.name + ")\n      options=" + in_quotes(options) + "\n      words=" + in_quotes(positional) + "\n";
    if (!values.empty()) cases += "      case $previous in\n" + values + "      esac\n";
    cases += "      ;;\n";
  }
  return "# Completion of swath for bash, made by `swath completion bash`.\n"
         "_swath() {\n"
         "  local current previous options='' words='' value=''\n"
         "  COMPREPLY=()\n"
         "  _get_comp_words_by_ref -n = -c current -p previous 2>/dev/null || { current=${COMP_WORDS[COMP_CWORD]}; "
         "previous=${COMP_WORDS[COMP_CWORD-1]}; }\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    COMPREPLY=($(compgen -W " +
         in_quotes(names + " --help --version") +
         " -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  case ${COMP_WORDS[1]} in\n" +
         cases +
         "  esac\n"
         "  if [ -z \"$value\" ] && [ \"${current:0:1}\" = - ]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "    return\n"
         "  fi\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  if [ ${#COMPREPLY[@]} -gt 0 ] && [ \"${COMPREPLY[0]: -1}\" = = ]; then compopt -o nospace 2>/dev/null; return; fi\n"
         "  compopt -o filenames 2>/dev/null\n"
         "  COMPREPLY+=($(compgen -f -- \"$current\"))\n"
         "}\n"
         "complete -F _swath swath\n";
}

std::string zsh_completion(const std::vector<CommandText>& commands, const Words& words) {
  std::string names, cases;
  for (const CommandText& c : commands) {
    names += "    " + in_quotes(replaced(c.name, ":", "\\:") + ":" + c.sentence) + "\n";
    cases += "    " + c.name + ")\n      _arguments";
    for (const OptionText& o : c.options) {
      const std::vector<std::string>* list = words_for(c, o, words);
      const std::string action = list ? "(" + joined(*list) + ")" : "_files";
      if (o.positional) {
        const std::string both = list && has_name(o, "CONFIG") ? "_alternative 'names:name:" + action + "' 'files:file:_files'" : action;
        cases += " \\\n        " + in_quotes(std::string(o.is_repeated ? "*" : "") + ":" + o.names.front() + ":" + both);
        continue;
      }
      for (const std::string& name : o.names)
        cases += " \\\n        " + in_quotes("*" + name + "[" + in_brackets(o.help) + "]" + (o.takes_value ? ":value:" + action : ""));
    }
    cases += "\n      ;;\n";
  }
  return "#compdef swath\n# Completion of swath for zsh, made by `swath completion zsh`.\n_swath() {\n  local -a commands=(\n" + names +
         "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n" +
         cases + "  esac\n}\n_swath \"$@\"\n";
}

std::string fish_completion(const std::vector<CommandText>& commands, const Words& words) {
  std::string out = "# Completion of swath for fish, made by `swath completion fish`.\n";
  for (const CommandText& c : commands)
    out += "complete -c swath -n __fish_use_subcommand -x -a " + c.name + " -d " + in_quotes(c.sentence) + "\n";
  for (const CommandText& c : commands) {
    const std::string here = "complete -c swath -n '__fish_seen_subcommand_from " + c.name + "'";
    for (const OptionText& o : c.options) {
      const std::vector<std::string>* list = words_for(c, o, words);
      const std::string takes = list ? " -a " + in_quotes(joined(*list)) : "";
      if (o.positional) {
        if (list) out += here + takes + "\n";
        continue;
      }
      std::string line = here;
      for (const std::string& name : o.names) line += name.starts_with("--") ? " -l " + name.substr(2) : " -s " + name.substr(1);
      out += line + (o.takes_value ? list ? " -x" + takes : " -r -F" : "") + " -d " + in_quotes(o.help) + "\n";
    }
  }
  return out;
}

}  // namespace swath::tools
