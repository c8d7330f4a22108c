// poecal completion: what a shell completes, and the manual page, made from the options' own texts.
#include <algorithm>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "commands.hpp"
#include "terminal.hpp"

namespace poecal::app {
namespace {

constexpr const char* kExample = R"(
Example:
  $ poecal completion bash > ~/.local/share/bash-completion/completions/poecal
  $ poecal completion zsh > ~/.zfunc/_poecal
  $ poecal completion man > ~/.local/share/man/man1/poecal.1
)";

std::vector<const CLI::App*> commandsOf(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

/// Options that have a long name, those of the program among a command's.
std::vector<const CLI::Option*> optionsOf(const CLI::App& command) {
  std::vector<const CLI::Option*> options;
  for (const CLI::App* app : {&command, command.get_parent()}) {
    if (app == nullptr) continue;
    for (const CLI::Option* option : app->get_options()) {
      const bool there = std::any_of(options.begin(), options.end(),
                                     [&](const CLI::Option* known) { return known->get_lnames() == option->get_lnames(); });
      if (!option->get_lnames().empty() && !there) options.push_back(option);
    }
  }
  return options;
}

std::string longName(const CLI::Option& option) { return "--" + option.get_lnames().front(); }
bool takesValue(const CLI::Option& option) { return option.get_items_expected_max() > 0 && option.get_type_size_max() > 0; }

std::string replaced(const std::string& text, const std::vector<std::pair<char, std::string>>& by) {
  std::string result;
  for (const char c : text) {
    const auto found = std::find_if(by.begin(), by.end(), [c](const auto& pair) { return pair.first == c; });
    result += found == by.end() ? std::string(1, c) : found->second;
  }
  return result;
}

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::string bashText(const CLI::App& program) {
  const std::vector<const CLI::App*> commands = commandsOf(program);
  const auto words = [](const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::Option* option : optionsOf(app)) names.push_back(longName(*option));
    return names;
  };
  const std::vector<std::string> names = namesOf(commands);
  std::string text = fmt::format(R"(# Completion of poecal for bash.
_poecal() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command='' word words
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case $word in {}) command=$word && break ;; esac
  done
  case $command in
)",
                                 fmt::join(names, "|"));
  for (const CLI::App* command : commands)
    text += fmt::format("    {}) words='{}' ;;\n", command->get_name(), fmt::join(words(*command), " "));
  text += fmt::format("    *) words='{} {}' ;;\n", fmt::join(names, " "), fmt::join(words(program), " "));
  return text + R"(  esac
  COMPREPLY=()
  if [[ -z $command || $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  fi
}
complete -o default -F _poecal poecal
)";
}

std::string zshText(const CLI::App& program) {
  const auto quoted = [](const std::string& text) {
    return replaced(text, {{'\'', "'\\''"}, {'[', "\\["}, {']', "\\]"}, {':', "\\:"}, {'\n', " "}});
  };
  std::string text = "#compdef poecal\n_poecal() {\n  local -a commands=(\n";
  const std::vector<const CLI::App*> commands = commandsOf(program);
  for (const CLI::App* command : commands) text += fmt::format("    '{}:{}'\n", command->get_name(), quoted(command->get_description()));
  text += "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n  case $words[2] in\n";
  for (const CLI::App* command : commands) {
    text += fmt::format("    {})\n      _arguments", command->get_name());
    for (const CLI::Option* option : optionsOf(*command)) {
      text += fmt::format(" \\\n        '{}[{}]{}'", longName(*option), quoted(option->get_description()),
                          takesValue(*option) ? ":value:_files" : "");
    }
    text += " \\\n        '*:file:_files'\n      ;;\n";
  }
  return text + "  esac\n}\n_poecal \"$@\"\n";
}

std::string manText(const CLI::App& program) {
  // A line that begins with a dot or a quote would be a request.
  const auto roff = [](const std::string& text) {
    std::string escaped = replaced(text, {{'\\', "\\e"}, {'-', "\\-"}, {'\n', "\n\\&"}});
    return "\\&" + escaped;
  };
  std::string text =
      fmt::format(".TH POECAL 1 \"\" \"poecal {}\"\n.SH NAME\npoecal \\- {}\n.SH SYNOPSIS\n.B poecal\nCOMMAND [OPTIONS]\n.SH OPTIONS\n",
                  POECAL_VERSION, roff(program.get_description()));
  const auto addOptions = [&](const CLI::App& app) {
    for (const CLI::Option* option : app.get_options()) {
      const std::string name = option->get_lnames().empty() ? option->get_name(true) : longName(*option);
      text += fmt::format(".TP\n.B {}{}\n{}\n", roff(name), takesValue(*option) && !option->get_lnames().empty() ? " VALUE" : "",
                          roff(option->get_description()));
    }
  };
  addOptions(program);
  text += ".SH COMMANDS\n";
  for (const CLI::App* command : commandsOf(program)) {
    text += fmt::format(".SS {}\n{}\n", roff(command->get_name()), roff(command->get_description()));
    addOptions(*command);
    if (!command->get_footer().empty()) text += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command->get_footer()));
  }
  return text;
}

}  // namespace

std::function<int()> setUpCompletion(CLI::App& app, const Common&) {
  const auto kind = std::make_shared<std::string>();
  app.add_option("KIND", *kind, "bash, zsh, or man for the manual page")->required()->check(CLI::IsMember({"bash", "zsh", "man"}));
  app.footer(kExample);
  return [kind, &app] {
    const CLI::App& program = *app.get_parent();
    printOut(*kind == "bash" ? bashText(program) : *kind == "zsh" ? zshText(program) : manText(program));
    return 0;
  };
}

}  // namespace poecal::app
