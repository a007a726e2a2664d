// SPDX-License-Identifier: Apache-2.0
//
// Options shared by the commands that make solids.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Vec3.h"
#include "tetvdb/pipeline/Preview.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"

#include <CLI/CLI.hpp>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <tbb/global_control.h>

namespace tetvdb::cli {

struct JobOptions {
  std::string voxelSize;
  int resolution = 256;
  std::string inside = "winding", shell, weld;
  bool keepOrientation = false;
  std::string epsilon;
  int threads = 0;
  std::string maxMemory, maxTime;
  std::string preview;
};

/// --voxel-size and --resolution.
void addSizeOptions(CLI::App& command, JobOptions& options);
/// --inside and --shell, for triangles.
void addInsideOptions(CLI::App& command, JobOptions& options);
/// --weld, for triangles.
void addWeldOption(CLI::App& command, JobOptions& options);
/// --weld and --keep-orientation, for triangles.
void addCleaningOptions(CLI::App& command, JobOptions& options);
/// --epsilon; the command says what it means and parses it.
void addEpsilonOption(CLI::App& command, JobOptions& options, const std::string& description);
/// --preview; `shows` says what is in the picture.
void addPreviewOption(CLI::App& command, JobOptions& options, const std::string& shows);
/// --max-memory and --max-time.
void addProcessLimitOptions(CLI::App& command, JobOptions& options);
/// --threads, --max-memory and --max-time.
void addLimitOptions(CLI::App& command, JobOptions& options);

// What was given, checked; each throws Error(Usage).
void setSize(const JobOptions& options, Vec3d& voxelSize, int& resolution);
void setInside(const JobOptions& options, SolidOptions& solid);
void setCleaning(const JobOptions& options, CleanOptions& clean);
/// Bytes; 0 where nothing was given.
std::size_t memoryLimit(const JobOptions& options);
/// One a core where nothing was given.
int threadCount(const JobOptions& options);

/// Allows that many threads while it lives: with Embree in the program oneTBB warns on stderr if
/// they are more than the cores.
class AllowThreads {
public:
  explicit AllowThreads(int threads);

private:
  tbb::global_control control_;
};

} // namespace tetvdb::cli
