// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/JobFiles.h"

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/core/ResidentBytes.h"
#include "tetvdb/io/source/ReferredFiles.h"
#include "tetvdb/pipeline/FindFrames.h"

#include <algorithm>
#include <filesystem>
#include <set>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

std::string_view thingsOf(FormatUse use) {
  switch (use) {
  case FormatUse::WriteTets:
    return " for tets";
  case FormatUse::WriteTriangles:
    return " for triangles";
  case FormatUse::WriteArrays:
    return " for arrays";
  default:
    return " for volumes";
  }
}

[[noreturn]] void failEnding(const std::string& path, std::string_view advice) {
  const std::string ending = endingOf(path);
  throw Error(Status::Usage, path,
              ending.empty() ? "the output's name has no extension"
                             : "cannot write files that end in '" + ending + "'",
              advice);
}

std::string megabytes(std::size_t bytes) {
  return std::to_string((bytes >> 20) + 1) + " MB";
}

} // namespace

OutputInfo written(const std::string& path) {
  std::error_code error;
  const auto bytes = fs::file_size(path, error);
  return {path, error ? 0 : static_cast<std::uint64_t>(bytes)};
}

std::vector<std::string> uniqueStems(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const std::string& path : paths) {
    const std::string stem = fs::path(path).stem().string();
    std::string name = stem;
    for (int n = 2; !taken.insert(name).second; ++n)
      name = stem + "_" + std::to_string(n);
    names.push_back(name);
  }
  return names;
}

void requireFormat(const std::string& path, std::initializer_list<FormatUse> uses) {
  std::string advice;
  for (const FormatUse use : uses) {
    if (formatForEnding(path, use) != nullptr)
      return;
    advice += (advice.empty() ? "name it " : ", ") + endingList(use);
    if (uses.size() > 1)
      advice += thingsOf(use);
  }
  failEnding(path, advice);
}

void requireExtension(const std::string& path, std::initializer_list<std::string_view> known,
                      std::string_view advice) {
  if (std::find(known.begin(), known.end(), endingOf(path)) == known.end())
    failEnding(path, advice);
}

void addInput(FileUse& files, const std::string& path) {
  files.reads(path);
  const std::vector<std::string> matching =
      isPattern(path) ? filesOf({path}) : std::vector<std::string>{path};
  for (const std::string& file : matching) {
    files.reads(file);
    for (const std::string& other : referredFiles(file))
      files.reads(other);
  }
}

void requireSeparateFiles(const std::vector<std::string>& inputs,
                          const std::vector<std::string>& outputs) {
  FileUse files;
  for (const std::string& input : inputs)
    addInput(files, input);
  for (const std::string& output : outputs)
    files.writes(output);
}

void requireWritable(const std::string& path) {
  const AtomicFile probe(path);
}

std::size_t memoryLeft(std::size_t limit) {
  if (limit == 0)
    return 0;
  const std::size_t used = residentBytes();
  if (used >= limit)
    throw Error(Status::Limit, "",
                "the mesh alone takes " + megabytes(used) + " of the " + megabytes(limit) +
                    " allowed",
                "raise `max_memory`, or read a part with `region` or `bbox`");
  return limit - used;
}

} // namespace tetvdb
