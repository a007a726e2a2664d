// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer program for the recognition of formats: any bytes, under a name that decides nothing
// and under one that decides what the bytes leave open.
#include "tetvdb/io/Formats.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"fuzz", "fuzz.node", "fuzz.stl"}) {
    tetvdb::formatName(tetvdb::sniffFormat(bytes, name));
    tetvdb::describeUnknownFormat(bytes, name);
  }
  return 0;
}
