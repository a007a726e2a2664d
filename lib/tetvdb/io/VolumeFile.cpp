// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VolumeFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/VolumeFormats.h"

#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace tetvdb {
namespace {

/// ".vdb" of "A.VDB".
std::string extension(const std::string& path) {
  std::string text = std::filesystem::path(path).extension().string();
  for (char& c : text)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

} // namespace

void writeVolume(const std::string& path, const Volume& volume, Progress& progress) {
  const std::string format = extension(path);
  if (format == ".vdb")
    return writeVdb(path, volume, progress);
  if (format == ".nvdb")
    return writeNvdb(path, volume, progress);
  throw Error(Status::Usage, path, "volumes are written as .vdb or .nvdb", "change the extension");
}

Volume readVolume(const std::string& path, Progress& progress) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Error(Status::Invalid, path, "is a directory", "name a .vdb or .nvdb file");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    throw Error(Status::Invalid, path,
                std::string("cannot open the file: ") + std::strerror(errno));
  char magic[8] = {};
  file.read(magic, sizeof magic);
  if (file.gcount() == 0)
    throw Error(Status::Invalid, path, "the file is empty");
  file.close();

  if (std::memcmp(magic, " BDV\0\0\0\0", 8) == 0)
    return readVdb(path, progress);
  if (std::memcmp(magic, "NanoVDB", 7) == 0)
    return readNvdb(path, progress);
  throw Error(Status::Invalid, path, "is neither a .vdb nor a .nvdb file");
}

} // namespace tetvdb
