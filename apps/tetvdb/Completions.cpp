// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "OptionList.h"

#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

const char* const kCompletionsExamples = R"(Examples:
  tetvdb completions bash > ~/.local/share/bash-completion/completions/tetvdb
  tetvdb completions zsh > /usr/local/share/zsh/site-functions/_tetvdb
  tetvdb completions fish > ~/.config/fish/completions/tetvdb.fish)";

/// `text` with a backslash before each of `characters`.
std::string escaped(const std::string& text, std::string_view characters) {
  std::string out;
  for (const char c : text) {
    if (characters.find(c) != characters.npos)
      out += '\\';
    out += c;
  }
  return out;
}

/// Within single quotes of bash and zsh, which know no escapes there.
std::string quoted(const std::string& text) {
  std::string out;
  for (const char c : text)
    out += c == '\'' ? "'\\''" : std::string(1, c);
  return "'" + out + "'";
}

std::string bashCompletions(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* command : commandsOf(program)) {
    names += " " + command->get_name();
    cases += "    " + command->get_name() + ") words='";
    for (const ListedOption& option : optionsOf(*command))
      for (const std::string& name : option.names)
        if (!option.positional)
          cases += name + " ";
    cases.back() = '\'';
    cases += " ;;\n";
  }
  return fmt::format(R"(_tetvdb() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} command= word words=
  for word in "${{COMP_WORDS[@]:1:COMP_CWORD-1}}"; do
    case $word in
    -*) ;;
    *) command=$word; break ;;
    esac
  done
  case $command in
    '') words='help{}' ;;
{}  esac
  if [[ -z $command || $current == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}}
complete -F _tetvdb tetvdb
)",
                     names, cases);
}

std::string zshCompletions(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* command : commandsOf(program)) {
    names += "    " +
             quoted(command->get_name() + ":" + escaped(command->get_description(), ":\\")) + "\n";
    cases += "    " + command->get_name() + ")\n      _arguments";
    for (const ListedOption& option : optionsOf(*command))
      for (const std::string& name : option.names)
        if (!option.positional)
          cases += " \\\n        " +
                   quoted(name + "[" + escaped(option.about, "[]\\") + "]" +
                          (option.value.empty() ? "" : ":" + option.value + ":_files"));
    cases += " \\\n        '*:file:_files' ;;\n";
  }
  return fmt::format(R"(#compdef tetvdb
_tetvdb() {{
  local -a commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_tetvdb "$@"
)",
                     names, cases);
}

std::string fishCompletions(const CLI::App& program) {
  const auto text = [](const std::string& about) { return "'" + escaped(about, "'\\") + "'"; };
  std::string out;
  for (const CLI::App* command : commandsOf(program)) {
    const std::string name = command->get_name();
    out += fmt::format("complete -c tetvdb -n __fish_use_subcommand -f -a {} -d {}\n", name,
                       text(command->get_description()));
    for (const ListedOption& option : optionsOf(*command)) {
      if (option.positional)
        continue;
      out += "complete -c tetvdb -n '__fish_seen_subcommand_from " + name + "'";
      for (const std::string& one : option.names)
        out += one[1] == '-' ? " -l " + one.substr(2) : " -s " + one.substr(1);
      out += (option.value.empty() ? "" : " -r") + std::string(" -d ") + text(option.about) + "\n";
    }
  }
  return out;
}

} // namespace

Command addCompletions(CLI::App& program) {
  CLI::App* command = program.add_subcommand(
      "completions", "Print a script by which a shell completes commands and options");
  auto shell = std::make_shared<std::string>();
  command->add_option("SHELL", *shell, "bash, zsh or fish")
      ->required()
      ->check(CLI::IsMember({"bash", "zsh", "fish"}).description(""))
      ->type_name("");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kCompletionsExamples);
  result.run = [shell, &program](Session& session) {
    session.text = *shell == "bash"  ? bashCompletions(program)
                   : *shell == "zsh" ? zshCompletions(program)
                                     : fishCompletions(program);
  };
  result.files = [] { return FileNames{}; };
  return result;
}

} // namespace tetvdb::cli
