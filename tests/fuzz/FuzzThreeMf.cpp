// SPDX-License-Identifier: Apache-2.0
//
// An archive, or the text of a model: the packed bytes of an archive hide it from the fuzzer.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ThreeMfModel.h"
#include "tetvdb/io/ThreeMfReader.h"

#include <cstddef>
#include <cstdint>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tetvdb::Report report;
    tetvdb::Progress progress;
    const tetvdb::Source source{{reinterpret_cast<const char*>(data), size}, "fuzz"};
    if (size > 0 && data[0] == 'P')
      tetvdb::readThreeMf(source, report, progress);
    else
      tetvdb::parseThreeMfModel(source.bytes, source.path, progress);
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
