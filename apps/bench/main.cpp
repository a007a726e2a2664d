// SPDX-License-Identifier: Apache-2.0
//
// tetvdb_bench: TetVDB and its peers side by side in one run. docs/benchmarks has the results.
#include "Book.h"
#include "Cases.h"
#include "Machine.h"
#include "PaperLoop.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <iostream>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace tetvdb::bench {
namespace {

/// An empty folder, removed with all that is in it.
class TemporaryFolder {
public:
  explicit TemporaryFolder(const std::string& parent) {
    std::string name = parent + "/tetvdb_bench.XXXXXX";
    if (mkdtemp(name.data()) == nullptr)
      throw std::runtime_error("cannot make a folder in " + parent);
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::string& path() const { return path_; }

private:
  std::string path_;
};

std::string casesHelp() {
  std::string text = "Cases:\n";
  for (const Case& entry : allCases())
    text += fmt::format("  {:<10} {}{}\n", entry.name, entry.about,
                        entry.onlyByName ? "; only when named" : "");
  return text;
}

/// What has to be given again to get the same page.
std::string optionsGiven(const Setup& setup) {
  std::string text;
  if (setup.repeat != Setup().repeat)
    text += fmt::format(" --repeat {}", setup.repeat);
  if (setup.shrink != Setup().shrink)
    text += fmt::format(" --shrink {}", setup.shrink);
  for (const std::string& mesh : setup.meshes)
    text += (&mesh == &setup.meshes.front() ? " --mesh " : " ") +
            std::filesystem::path(mesh).filename().string();
  if (setup.threads != tbb::this_task_arena::max_concurrency())
    text += fmt::format(" --threads {}", setup.threads);
  return text;
}

int run(int argc, char** argv) {
  Launcher launcher; // first of all: see Launcher
  std::vector<std::string> names;
  std::string json, book, parent = std::filesystem::temp_directory_path().string();
  Setup setup;
  setup.launcher = &launcher;
  setup.program = (std::filesystem::canonical("/proc/self/exe").parent_path() / "tetvdb").string();
  setup.threads = tbb::this_task_arena::max_concurrency();

  CLI::App app("Times TetVDB and its peers in turns and prints a table for each case.");
  app.add_option("case", names, "Cases to run (default: all that are not for special asking)");
  app.add_option("--repeat", setup.repeat,
                 "Rounds of each comparison, at most; slow ones take fewer")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--threads", setup.threads, "Threads of all rivals that can use several")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--json", json, "Also write all times to this file");
  app.add_option("--book", book,
                 "Write each case as a page with its plot and numbers into this folder, and anew "
                 "the page of all targets")
      ->type_name("FOLDER");
  app.add_option("--folder", parent, "Where temporary files go")->capture_default_str();
  app.add_option("--program", setup.program, "The tetvdb program that `large` and `huge` run")
      ->capture_default_str();
  app.add_option("--mesh", setup.meshes,
                 "Files of triangles, for `models` and for `triangles` instead of its own")
      ->check(CLI::ExistingFile);
  app.add_option("--shrink", setup.shrink, "So many times fewer tets and voxels, for a try")
      ->check(CLI::Range(1, 10000));
  app.footer(casesHelp());
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  std::vector<const Case*> chosen;
  for (const Case& entry : allCases())
    if (names.empty() ? !entry.onlyByName
                      : std::find(names.begin(), names.end(), entry.name) != names.end())
      chosen.push_back(&entry);
  for (const std::string& name : names)
    if (std::none_of(chosen.begin(), chosen.end(),
                     [&](const Case* c) { return c->name == name; })) {
      std::cerr << "there is no case '" << name << "'; --help lists them\n";
      return 2;
    }

  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(setup.threads));
  setLoopThreads(setup.threads);
  const TemporaryFolder folder(parent);
  setup.folder = folder.path();

  if (!book.empty()) // before hours of work, not after
    std::filesystem::create_directories(book);

  const double bandwidth = measureBandwidth();
  const nlohmann::ordered_json machine = describeMachine();
  std::printf("TetVDB %s; %s; threads %d; OpenMP %s; memory %.1f GB/s (triad, read + written)\n",
              machine["revision"].get<std::string>().c_str(),
              machine["processor"].get<std::string>().c_str(), setup.threads,
              haveOpenMP() ? "yes" : "no: the paper's loop runs on one thread", bandwidth * 1e-9);
  Tables tables(bandwidth);
  for (const Case* entry : chosen) {
    const Work before = workSoFar();
    const double seconds = secondsOf([&] { entry->run(setup, tables); });
    const Work after = workSoFar();
    const double others =
        std::max(0.0, (after.machine - before.machine - (after.own - before.own)) / seconds);
    std::printf("\n%.2f cores were busy with other programs\n", others);
    if (!book.empty())
      writeChapter(book, {tables.json().back(), entry->about,
                          fmt::format("tetvdb_bench {}{} --book docs/benchmarks", entry->name,
                                      optionsGiven(setup)),
                          machine, setup.threads, bandwidth, seconds, others});
  }
  if (!book.empty())
    writeTargets(book);

  if (!json.empty()) {
    std::ofstream file(json);
    file << nlohmann::ordered_json{{"machine", machine},     {"threads", setup.threads},
                                   {"openmp", haveOpenMP()}, {"bandwidth", bandwidth},
                                   {"shrink", setup.shrink}, {"cases", tables.json()}}
                .dump(2)
         << "\n";
    if (!file.flush()) {
      std::cerr << json << ": cannot write\n";
      return 7;
    }
  }
  return 0;
}

} // namespace
} // namespace tetvdb::bench

int main(int argc, char** argv) {
  try {
    if (argc > 1 && std::string(argv[1]) == "--child")
      return tetvdb::bench::trianglesChild({argv + 2, argv + argc});
    return tetvdb::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
