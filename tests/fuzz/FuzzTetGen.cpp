// SPDX-License-Identifier: Apache-2.0
//
// The two files of a TetGen mesh stand in one input, parted by a '|'.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/TetGenReader.h"
#include "tetvdb/mesh/SplitCells.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::size_t bar = std::min(bytes.find('|'), size);
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    const tetvdb::Source node{bytes.substr(0, bar), "fuzz.node"};
    const tetvdb::Source ele{bytes.substr(std::min(bar + 1, size)), "fuzz.ele"};
    tetvdb::splitCells(tetvdb::readTetGenPair(node, ele, {}, report, progress), {}, report,
                       progress);
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
