// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/text/ZlibBytes.h"

#include <new>
#include <zlib.h>

namespace tetvdb {

std::string zlibBytes(const char* bytes, std::size_t size) {
  uLongf length = compressBound(static_cast<uLong>(size));
  std::string packed(length, '\0');
  if (compress(reinterpret_cast<Bytef*>(packed.data()), &length,
               reinterpret_cast<const Bytef*>(bytes), static_cast<uLong>(size)) != Z_OK)
    throw std::bad_alloc();
  packed.resize(length);
  return packed;
}

} // namespace tetvdb
