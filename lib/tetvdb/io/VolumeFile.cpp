// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VolumeFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/Source.h"

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string_view>

namespace tetvdb {

void writeVolume(const std::string& path, const Volume& volume, Progress& progress) {
  const Format* format = formatForEnding(path, FormatUse::WriteVolume);
  if (format == nullptr)
    throw Error(Status::Usage, path, "volumes are written as " + endingList(FormatUse::WriteVolume),
                "change the extension");
  format->writeVolume(path, volume, progress);
}

Volume readVolume(const std::string& path, Progress& progress) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Error(Status::Invalid, path, "is a directory",
                "name a " + endingList(FormatUse::ReadVolume) + " file");
  std::ifstream file(path, std::ios::binary);
  if (!file)
    failToOpen(path, errno);
  char start[4096] = {};
  file.read(start, sizeof start);
  if (file.gcount() == 0)
    throw Error(Status::Invalid, path, "the file is empty");
  const std::string_view bytes(start, static_cast<std::size_t>(file.gcount()));
  file.close();

  const Format& format = formatOf(sniffFormat(bytes, path));
  if (format.readVolume == nullptr)
    throw Error(Status::Invalid, path,
                "is no volume: neither " + endingList(FormatUse::ReadVolume, "nor"));
  return format.readVolume(path, progress);
}

} // namespace tetvdb
