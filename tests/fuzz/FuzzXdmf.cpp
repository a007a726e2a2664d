// SPDX-License-Identifier: Apache-2.0
//
// The XML and the numbers in it; files beside are looked for in a folder that does not exist.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/XdmfReader.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tetvdb::Source source{{reinterpret_cast<const char*>(data), size},
                              "/nonexistent/folder/fuzz.xdmf"};
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    tetvdb::readXdmf(source, {}, report, progress);
    tetvdb::xdmfTimes(source);
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
