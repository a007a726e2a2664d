// SPDX-License-Identifier: Apache-2.0
#include "Book.h"

#include "Plot.h"
#include "Results.h"
#include "Table.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <stdexcept>
#include <vector>

namespace tetvdb::bench {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

void write(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush())
    throw std::runtime_error(path.string() + ": cannot write");
}

std::string machineOf(const Json& machine) {
  const auto text = [&](const char* name) { return machine.at(name).get<std::string>(); };
  return fmt::format("{}, {} cores, {} of last-level cache, {} of memory", text("processor"),
                     machine.at("cores").get<int>(), text("cache"), text("memory"));
}

std::string pageOf(const Chapter& chapter) {
  const std::string name = chapter.entry.at("case");
  const auto text = [&](const char* key) { return chapter.machine.at(key).get<std::string>(); };
  std::string page = fmt::format(
      "<!-- written by tetvdb_bench; what is changed here is lost when it runs again -->\n"
      "# {}: {}\n\n{}\n\n    {}\n\n",
      name, chapter.title, chapter.entry.at("about").get<std::string>(), chapter.command);
  page += markdown(
      {{"", ""},
       {"date", text("date")},
       {"machine", machineOf(chapter.machine)},
       {"built by", fmt::format("{}; {}; {}", text("compiler"), text("libraries"), text("system"))},
       {"TetVDB", fmt::format("{}, commit {}", text("version"), text("revision"))},
       {"threads", fmt::format("{}", chapter.threads)},
       {"memory", fmt::format("{:.1f} GB/s, triad, read and written", chapter.bandwidth * 1e-9)},
       {"other programs", fmt::format("{:.2f} cores busy with them in the mean, in {}",
                                      chapter.otherWork, duration(chapter.seconds))}});
  page += fmt::format("\n![times]({}.svg)\n\n", name) + markdown(tableOf(chapter.entry)) + "\n";
  for (const Json& note : chapter.entry.at("notes"))
    page += fmt::format("- {}\n", note.get<std::string>());
  return page;
}

} // namespace

void writeChapter(const std::string& folder, const Chapter& chapter) {
  const fs::path base = fs::path(folder) / chapter.entry.at("case").get<std::string>();
  write(base.string() + ".md", pageOf(chapter));
  write(base.string() + ".svg", plot(chapter.entry));
  write(base.string() + ".json", Json{{"title", chapter.title},
                                      {"command", chapter.command},
                                      {"machine", chapter.machine},
                                      {"threads", chapter.threads},
                                      {"bandwidth", chapter.bandwidth},
                                      {"seconds", chapter.seconds},
                                      {"other_work", chapter.otherWork},
                                      {"result", chapter.entry}}
                                         .dump(1) +
                                     "\n");
}

void writeTargets(const std::string& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".json")
      paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<std::vector<std::string>> lines = {
      {"what", "peer", "asked", "ours", "peer's", "ratio", "reached", "measured"}};
  std::size_t reached = 0;
  for (const fs::path& path : paths) {
    std::ifstream file(path);
    const Json chapter = Json::parse(file);
    for (const Json& row : chapter.at("result").at("rows"))
      for (const Target& target : targetsOf(row)) {
        lines.push_back({row.at("what"), row.at("peer"), target.asked, target.ours, target.peer,
                         target.ratio, target.reached ? "yes" : "**no**",
                         fmt::format("[{0}]({0}.md), {1}", path.stem().string(),
                                     chapter.at("machine").at("date").get<std::string>())});
        reached += target.reached;
      }
  }
  write(fs::path(folder) / "targets.md",
        fmt::format(
            "<!-- written by tetvdb_bench; what is changed here is lost when it runs again -->\n"
            "# Targets\n\n{} of {} are reached. Times are medians; each chapter says on what "
            "machine and by which command.\n\n",
            reached, lines.size() - 1) +
            markdown(lines));
}

} // namespace tetvdb::bench
