// SPDX-License-Identifier: Apache-2.0
#include "OptionNames.h"

#include <algorithm>

namespace tetvdb::cli {
namespace {

constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz_";

// "" where `setting` is no name, or no name with a value.
std::string optionOf(std::string_view setting) {
  const std::size_t end = std::min(setting.find_first_not_of(kLetters), setting.size());
  if (end == 0 || (end < setting.size() && setting[end] != '='))
    return {};
  std::string option = "--" + std::string(setting);
  std::replace(option.begin(), option.begin() + static_cast<std::ptrdiff_t>(end + 2), '_', '-');
  if (end < setting.size())
    option[end + 2] = ' ';
  return option;
}

} // namespace

std::string withOptionNames(std::string_view text) {
  std::string out;
  for (;;) {
    const std::size_t open = text.find('`');
    const std::size_t close = open == text.npos ? open : text.find('`', open + 1);
    if (close == text.npos)
      return out.append(text);
    const std::string option = optionOf(text.substr(open + 1, close - open - 1));
    // A backquote that opens nothing may be followed by one that does.
    out += option.empty() ? std::string(text.substr(0, close))
                          : std::string(text.substr(0, open)) + option;
    text.remove_prefix(option.empty() ? close : close + 1);
  }
}

} // namespace tetvdb::cli
