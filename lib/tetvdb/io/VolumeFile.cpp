// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/VolumeFile.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/Source.h"

#include <filesystem>

namespace tetvdb {

void writeVolume(const std::string& path, const Volume& volume, Progress& progress) {
  const Format* format = formatForEnding(path, FormatUse::WriteVolume);
  if (format == nullptr)
    throw Error(Status::Usage, path, "volumes are written as " + endingList(FormatUse::WriteVolume),
                "change the extension");
  format->writeVolume(path, volume, progress);
}

FileFormat volumeFormatOf(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error))
    return FileFormat::Unknown;
  try {
    const MappedFile file(path);
    const FileFormat found = sniffFormat(file.bytes(), path);
    return can(formatOf(found), FormatUse::ReadVolume) ? found : FileFormat::Unknown;
  } catch (const Error&) {
    return FileFormat::Unknown;
  }
}

Volume readVolume(const std::string& path, Progress& progress) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw Error(Status::Invalid, path, "is a directory",
                "name a " + endingList(FormatUse::ReadVolume) + " file");
  const Format& format = [&]() -> const Format& {
    const MappedFile file(path);
    return formatOf(sniffFormat(file.bytes(), path));
  }();
  if (!can(format, FormatUse::ReadVolume))
    throw Error(Status::Invalid, path,
                "is no volume: neither " + endingList(FormatUse::ReadVolume, "nor"));
  return format.readVolume != nullptr ? format.readVolume(path, progress)
                                      : readArrays(path, {}, progress);
}

} // namespace tetvdb
