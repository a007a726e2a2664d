// SPDX-License-Identifier: Apache-2.0
//
// Pages for man(1), made of the parser's texts. Format: man(7).
#include "Commands.h"
#include "OptionList.h"
#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/Version.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <utility>

namespace tetvdb::cli {
namespace {

namespace fs = std::filesystem;

const char* const kManualExamples = R"(Examples:
  tetvdb manual ~/.local/share/man/man1
      tetvdb.1, tetvdb-voxelize.1 and so on; read them by 'man tetvdb-voxelize')";

/// Text as troff takes it: no escapes, no requests at the beginnings of lines.
std::string plain(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if ((c == '.' || c == '\'') && (out.empty() || out.back() == '\n'))
      out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
  }
  return out;
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 32) : c; });
  return text;
}

std::string title(const std::string& name, const std::string& about) {
  return fmt::format(".TH {} 1 \"\" \"TetVDB {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
                     upper(plain(name)), version(), plain(name), plain(about));
}

/// The footer of a help text: examples, as they stand.
std::string notes(const CLI::App& app) {
  const std::string footer = app.get_footer();
  return footer.empty() ? "" : ".SH NOTES\n.nf\n" + plain(footer) + "\n.fi\n";
}

std::string pageOf(const CLI::App& command) {
  const std::string name = "tetvdb-" + command.get_name();
  std::string synopsis = ".SH SYNOPSIS\n.B tetvdb " + plain(command.get_name());
  std::string positionals, options;
  for (const ListedOption& option : optionsOf(command)) {
    std::string names;
    for (const std::string& one : option.names)
      names += (names.empty() ? "" : ", ") + ("\\fB" + plain(one) + "\\fR");
    std::string entry = ".TP\n" + names;
    if (!option.positional && !option.value.empty())
      entry += " \\fI" + plain(option.value) + "\\fR";
    entry += "\n" + plain(option.about);
    if (!option.initial.empty())
      entry += " (default: " + plain(option.initial) + ")";
    (option.positional ? positionals : options) += entry + "\n";
    if (option.positional)
      synopsis += "\n.I " + plain(option.names.front());
  }
  return title(name, command.get_description()) + synopsis + "\n[\\fIoptions\\fR]\n" +
         ".SH OPTIONS\n" + positionals + options + notes(command) +
         ".SH SEE ALSO\n.BR tetvdb (1)\n";
}

std::string programPage(const CLI::App& program) {
  std::string commands, others;
  for (const CLI::App* command : commandsOf(program)) {
    commands += ".TP\n\\fB" + plain(command->get_name()) + "\\fR\n" +
                plain(command->get_description()) + "\n";
    others += ".BR tetvdb\\-" + plain(command->get_name()) + " (1)\n";
  }
  return title("tetvdb", program.get_description()) +
         ".SH SYNOPSIS\n.B tetvdb\n\\fIcommand\\fR [\\fIoptions\\fR]\n.SH COMMANDS\n" + commands +
         notes(program) + ".SH SEE ALSO\n" + others;
}

void runManual(const CLI::App& program, const std::string& folder, Session& session) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder))
    throw Error(Status::Write, folder, "is no folder and cannot be made one");
  const auto write = [&](const std::string& name, const std::string& page) {
    AtomicFile file((fs::path(folder) / (name + ".1")).string());
    file.write(page.data(), page.size());
    file.commit();
    session.text += file.path() + "\n";
  };
  write("tetvdb", programPage(program));
  for (const CLI::App* command : commandsOf(program))
    write("tetvdb-" + command->get_name(), pageOf(*command));
  session.textIsSummary = true;
}

} // namespace

Command addManual(CLI::App& program) {
  CLI::App* command = program.add_subcommand("manual", "Write manual pages for man(1)");
  auto folder = std::make_shared<std::string>();
  command->add_option("DIR", *folder, "Folder, such as share/man/man1")
      ->required()
      ->check(notEmpty())
      ->type_name("");
  Command result{command, addCommonOptions(*command), {}};
  command->footer(kManualExamples);
  result.run = [folder, &program](Session& session) { runManual(program, *folder, session); };
  result.files = [] { return FileNames{}; };
  return result;
}

} // namespace tetvdb::cli
