// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/volume/PartMetadata.h"

#include <cstdio>
#include <fmt/format.h>

namespace tetvdb {
namespace {

constexpr const char* kPart = "part";
constexpr const char* kJob = "part_of";

} // namespace

void PartMetadata::add(std::map<std::string, std::string>& metadata) const {
  metadata[kPart] = fmt::format("{}/{}", index, count);
  metadata[kJob] = job;
}

bool PartMetadata::take(std::map<std::string, std::string>& metadata) {
  const auto part = metadata.find(kPart), of = metadata.find(kJob);
  if (part == metadata.end() || of == metadata.end())
    return false;
  const bool read = std::sscanf(part->second.c_str(), "%9u/%9u", &index, &count) == 2;
  job = of->second;
  metadata.erase(part);
  metadata.erase(of);
  return read && index < count;
}

} // namespace tetvdb
