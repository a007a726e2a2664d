// SPDX-License-Identifier: Apache-2.0
#include "ParseError.h"

#include "tetvdb/core/ClosestName.h"

#include <algorithm>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

std::vector<std::string> namesOf(const std::vector<Command>& commands) {
  std::vector<std::string> names;
  for (const Command& command : commands)
    names.push_back(command.parser->get_name());
  return names;
}

// "a, b and c".
std::string listed(const std::vector<std::string>& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i)
    text += (i == 0 ? "" : i + 1 < words.size() ? ", " : " and ") + words[i];
  return text;
}

std::string withSuggestion(std::string text, const std::string& closest) {
  return closest.empty() ? text : text + "; did you mean " + closest + "?";
}

std::string unknownOption(const std::string& word, const CLI::App& command) {
  const std::string name = word.substr(0, word.find('='));
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& longName : option->get_lnames())
      names.push_back(longName);
  const std::string closest =
      name.compare(0, 2, "--") == 0 ? closestName(name.substr(2), names) : std::string();
  return withSuggestion(command.get_name() + " has no option " + name,
                        closest.empty() ? "" : "--" + closest);
}

// CLI11 says "--mesher: foo not in {auto,winding}".
std::string unknownValue(const std::string& text) {
  const std::size_t colon = text.find(": "), notIn = text.find(" not in {");
  if (colon == text.npos || notIn == text.npos || colon > notIn || text.back() != '}')
    return text;
  const std::string value = text.substr(colon + 2, notIn - colon - 2);
  std::vector<std::string> words;
  for (std::size_t at = notIn + 9; at < text.size();) {
    const std::size_t end = text.find_first_of(",}", at);
    words.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  const std::string closest = closestName(value, words);
  return withSuggestion(
      fmt::format("{}: '{}' is none of {}", text.substr(0, colon), value, listed(words)),
      closest.empty() ? "" : "'" + closest + "'");
}

// CLI11 says "Could not convert: --resolution = x".
std::string unreadableNumber(const std::string& text) {
  const std::string before = "Could not convert: ";
  const std::size_t equals = text.find(" = ");
  if (text.compare(0, before.size(), before) != 0 || equals == text.npos)
    return text;
  return fmt::format("{}: '{}' is no number that can be used here",
                     text.substr(before.size(), equals - before.size()), text.substr(equals + 3));
}

std::string unexpectedWords(const CLI::App& program, const CLI::App& command) {
  const std::vector<std::string> extras = program.remaining(true);
  const auto option = std::find_if(extras.begin(), extras.end(), [](const std::string& word) {
    return word.size() > 1 && word[0] == '-';
  });
  if (option != extras.end())
    return unknownOption(*option, command);
  return extras.empty() ? "too many words were given"
                        : fmt::format("'{}' was not expected", extras.front());
}

} // namespace

const Command* findCommand(const std::string& name, const std::vector<Command>& commands) {
  for (const Command& command : commands)
    if (command.parser->get_name() == name)
      return &command;
  return nullptr;
}

std::string describeUnknownCommand(const std::string& name, const std::vector<Command>& commands) {
  const std::vector<std::string> names = namesOf(commands);
  const std::string closest = closestName(name, names);
  return withSuggestion(fmt::format("'{}' is no command; there are {}", name, listed(names)),
                        closest.empty() ? "" : "'" + closest + "'") +
         (closest.empty() ? "; see" : " See") + " 'tetvdb --help'";
}

std::string describeParseError(const CLI::ParseError& error, const std::vector<std::string>& words,
                               const CLI::App& program, const std::vector<Command>& commands) {
  if (words.empty())
    return "a command is missing; see 'tetvdb --help'";
  const Command* command = findCommand(words.front(), commands);
  if (command == nullptr && words.front()[0] != '-')
    return describeUnknownCommand(words.front(), commands);
  std::string text = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    text = unexpectedWords(program, command == nullptr ? program : *command->parser);
  else if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr)
    text = unknownValue(text);
  else if (dynamic_cast<const CLI::ConversionError*>(&error) != nullptr)
    text = unreadableNumber(text);
  const std::string help =
      command == nullptr ? "tetvdb --help" : "tetvdb help " + command->parser->get_name();
  return text + (text.back() == '?' ? " See '" : "; see '") + help + "'";
}

} // namespace tetvdb::cli
