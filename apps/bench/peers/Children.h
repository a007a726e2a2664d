// SPDX-License-Identifier: Apache-2.0
//
// Other programs: the command line, measured as a whole process, and VTK in Python.
#pragma once

#include "PaperLoop.h"

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace tetvdb::bench {

/// How a process ended.
struct ChildResult {
  int status = -1; ///< exit status, 128 + signal, or -1 where it could not be started
  double seconds = 0;
  std::size_t peakBytes = 0;
};

/// Starts programs from a small process that is forked before this one grows. Linux counts the
/// memory of whoever forks as the child's own peak, also after exec; so a benchmark that holds
/// gigabytes of meshes cannot start its children itself.
class Launcher {
public:
  /// To be made first thing in main(), before any thread exists.
  Launcher();
  ~Launcher();
  Launcher(const Launcher&) = delete;
  Launcher& operator=(const Launcher&) = delete;

  /// Runs a program to its end; its standard output is thrown away.
  ChildResult run(const std::vector<std::string>& command);

private:
  int socket_ = -1;
  int process_ = -1;
};

/// VTK's vtkResampleToImage in a Python process that stays, so that runs can take turns with ours.
/// Debian's libvtk has no development files unless 308 packages are installed; the filter is the
/// same compiled code from either language, and the seconds are those of its Update() alone.
class VtkPeer {
public:
  /// Reads the .vtu `mesh` with cell array `array`. available() is false where Python or its VTK is
  /// missing, and why() then says so.
  VtkPeer(const std::string& mesh, const std::string& array, int threads);
  ~VtkPeer();
  VtkPeer(const VtkPeer&) = delete;
  VtkPeer& operator=(const VtkPeer&) = delete;

  bool available() const { return available_; }
  const std::string& why() const { return why_; }
  const std::string& version() const { return version_; }

  /// Samples at `size` points an axis from `low` to `high`; seconds.
  double run(const int (&size)[3], const double (&low)[3], const double (&high)[3]);
  /// The same at the voxel centres of `box`.
  double run(const VoxelBox& box, const GridTransform& transform);
  std::size_t activeVoxels() const { return activeVoxels_; }
  /// Highest resident memory of its process so far; 0 where the system does not tell.
  std::size_t peakBytes() const;

private:
  std::string line();

  int process_ = -1;
  std::FILE* to_ = nullptr;
  std::FILE* from_ = nullptr;
  bool available_ = false;
  std::string why_, version_;
  std::size_t activeVoxels_ = 0;
};

} // namespace tetvdb::bench
