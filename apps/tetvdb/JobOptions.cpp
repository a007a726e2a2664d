// SPDX-License-Identifier: Apache-2.0
#include "JobOptions.h"

#include "Commands.h"
#include "ParseQuantities.h"
#include "tetvdb/core/Error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <future>
#include <system_error>
#include <tbb/task_arena.h>
#include <thread>
#include <vector>

namespace tetvdb::cli {

void addSizeOptions(CLI::App& command, JobOptions& options) {
  CLI::Option* size =
      command.add_option("--voxel-size", options.voxelSize, "A voxel's side, or one for each axis")
          ->type_name("H|HX,HY,HZ")
          ->check(notEmpty());
  command
      .add_option("--resolution", options.resolution,
                  "Voxels along the longest side of the mesh (default 256)")
      ->type_name("N")
      ->excludes(size);
}

void addInsideOptions(CLI::App& command, JobOptions& options) {
  command
      .add_option("--inside", options.inside,
                  "What is inside triangles: winding number above 0.5 (default), of any sign "
                  "(nonzero), odd (parity), or not reached from outside (flood)")
      ->check(CLI::IsMember({"winding", "nonzero", "parity", "flood"}).description(""))
      ->type_name("RULE");
  command
      .add_option(
          "--shell", options.shell,
          "No solid but a shell of thickness T, half of it on either side of the triangles, "
          "for open sheets")
      ->type_name("T")
      ->check(notEmpty());
}

void addPreviewOption(CLI::App& command, JobOptions& options, const std::string& shows) {
  command
      .add_option("--preview", options.preview,
                  "Write a picture as well, .png: " + shows + ", side by side")
      ->type_name("FILE")
      ->check(notEmpty());
}

void addWeldOption(CLI::App& command, JobOptions& options) {
  command
      .add_option("--weld", options.weld,
                  "Join points nearer than D; 0: equal ones (default: equal "
                  "ones, and boundary points that differ by rounding)")
      ->type_name("D")
      ->check(notEmpty());
}

void addCleaningOptions(CLI::App& command, JobOptions& options) {
  addWeldOption(command, options);
  command.add_flag("--keep-orientation", options.keepOrientation,
                   "Do not turn triangles that look the wrong way");
}

void addEpsilonOption(CLI::App& command, JobOptions& options, const std::string& description) {
  command.add_option("--epsilon", options.epsilon, description)
      ->type_name("E|Ed|Ev")
      ->check(notEmpty());
}

void addLimitOptions(CLI::App& command, JobOptions& options) {
  command.add_option("--threads", options.threads, "Threads (default: one a core)")
      ->check(CLI::Range(1, 4096).description(""))
      ->type_name("N");
  addProcessLimitOptions(command, options);
}

void addProcessLimitOptions(CLI::App& command, JobOptions& options) {
  command
      .add_option("--max-memory", options.maxMemory,
                  "Take no more than 500M, 4G, ...: stream or refuse what needs more (default: "
                  "what is free)")
      ->type_name("BYTES")
      ->check(notEmpty());
  command.add_option("--max-time", options.maxTime, "Stop after so many seconds, without output")
      ->type_name("SECONDS")
      ->check(notEmpty());
}

void setSize(const JobOptions& options, Vec3d& voxelSize, int& resolution) {
  if (!options.voxelSize.empty())
    voxelSize = parseVoxelSize("--voxel-size", options.voxelSize);
  if (options.resolution < 1)
    throw Error(Status::Usage, "--resolution",
                fmt::format("'{}' cannot be used", options.resolution),
                "give a number of voxels above zero");
  resolution = options.resolution;
}

void setInside(const JobOptions& options, SolidOptions& solid) {
  solid.inside = parseInsideRule(options.inside);
  if (!options.shell.empty())
    solid.shell = parseLength("--shell", options.shell);
}

void setCleaning(const JobOptions& options, CleanOptions& clean) {
  clean.orient = !options.keepOrientation;
  if (!options.weld.empty())
    clean.weldDistance = options.weld == "0" ? 0 : parseLength("--weld", options.weld);
}

std::size_t memoryLimit(const JobOptions& options) {
  return options.maxMemory.empty() ? 0 : parseBytes("--max-memory", options.maxMemory);
}

int threadCount(const JobOptions& options) {
  return options.threads == 0 ? tbb::this_task_arena::max_concurrency() : options.threads;
}

namespace {

/// As many of `wanted` threads, this one included, as the system lets the process have at once.
/// oneTBB, and Embree above all, do not recover from one that cannot be started.
int startableThreads(int wanted) {
  std::promise<void> done;
  const std::shared_future<void> until = done.get_future().share();
  std::vector<std::thread> threads;
  try {
    for (int i = 1; i < wanted; ++i)
      threads.emplace_back([until] { until.wait(); });
  } catch (const std::system_error&) {
  }
  const int count = 1 + static_cast<int>(threads.size());
  done.set_value();
  for (std::thread& thread : threads)
    thread.join();
  return count;
}

std::size_t parallelism(int threads) {
  const int startable = startableThreads(threads);
  if (startable < threads)
    return static_cast<std::size_t>(startable);
  return std::max(static_cast<std::size_t>(threads),
                  tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

} // namespace

AllowThreads::AllowThreads(int threads)
    : control_(tbb::global_control::max_allowed_parallelism, parallelism(threads)) {}

} // namespace tetvdb::cli
