// SPDX-License-Identifier: Apache-2.0
//
// One libFuzzer program a format of volumes: CMake compiles this file for each with
// TETVDB_FUZZ_READ, the reader. What is read has trees that can be walked.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/volume/VolumeFormats.h"
#include "tetvdb/volume/Grids.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <sys/mman.h>
#include <unistd.h>

// OpenVDB leaks the node at whose values Blosc fails.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:readTopology\nleak:readBuffers\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("fuzz", MFD_CLOEXEC);
  static const std::string path = "/proc/self/fd/" + std::to_string(file);
  if (::ftruncate(file, 0) != 0 || ::pwrite(file, data, size, 0) != ssize_t(size))
    std::abort();
  tetvdb::Progress progress;
  try {
    const tetvdb::Volume volume = tetvdb::TETVDB_FUZZ_READ(path, progress);
    for (const auto& grid : volume.grids().all) {
      grid->activeVoxelCount();
      grid->evalActiveVoxelBoundingBox();
    }
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
