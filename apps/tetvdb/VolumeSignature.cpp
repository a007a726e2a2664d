// SPDX-License-Identifier: Apache-2.0
#include "VolumeSignature.h"

#include <fstream>
#include <string_view>

namespace tetvdb::cli {

VolumeSignature signatureOf(const std::string& path) {
  char start[8] = {};
  std::ifstream file(path, std::ios::binary);
  file.read(start, sizeof start);
  const std::string_view bytes(start, static_cast<std::size_t>(file.gcount()));
  if (bytes == std::string_view(" BDV\0\0\0\0", 8))
    return VolumeSignature::OpenVDB;
  if (bytes.substr(0, 7) == "NanoVDB")
    return VolumeSignature::NanoVDB;
  return VolumeSignature::None;
}

} // namespace tetvdb::cli
