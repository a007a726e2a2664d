// SPDX-License-Identifier: Apache-2.0
#include "OptionList.h"

#include <algorithm>

namespace tetvdb::cli {

std::vector<const CLI::App*> commandsOf(const CLI::App& program) {
  return program.get_subcommands(
      [](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<ListedOption> optionsOf(const CLI::App& command) {
  std::vector<ListedOption> list;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty())
      continue;
    ListedOption listed;
    listed.positional = option->get_positional();
    if (listed.positional)
      listed.names.push_back(option->get_name(true));
    for (const std::string& name : option->get_snames())
      listed.names.push_back("-" + name);
    for (const std::string& name : option->get_lnames())
      listed.names.push_back("--" + name);
    if (option->get_items_expected_max() != 0) {
      const std::string type = option->get_type_name(); // its validators follow a colon
      listed.value = type.substr(0, type.find(':'));
      if (listed.value.empty())
        listed.value = "VALUE";
    }
    listed.initial = option->get_default_str();
    listed.about = option->get_description();
    listed.required = option->get_required();
    list.push_back(std::move(listed));
  }
  std::stable_partition(list.begin(), list.end(),
                        [](const ListedOption& option) { return option.positional; });
  return list;
}

} // namespace tetvdb::cli
