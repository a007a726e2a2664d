// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/StlReader.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    const tetvdb::Source source{{reinterpret_cast<const char*>(data), size}, "fuzz"};
    const tetvdb::TriangleMesh mesh = tetvdb::readStl(source, report, progress);
    for (const std::uint32_t corner : mesh.triangles)
      if (corner >= mesh.points.size())
        std::abort();
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
