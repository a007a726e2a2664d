// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/MeditReader.h"
#include "tetvdb/mesh/SplitCells.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    const tetvdb::Source source{{reinterpret_cast<const char*>(data), size}, "fuzz"};
    const bool text = size > 0 && data[0] > 1; // binary files begin with 1 or 0
    const auto read = text ? tetvdb::readMedit : tetvdb::readMeditBinary;
    tetvdb::splitCells(read(source, {}, report, progress), {}, report, progress);
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
