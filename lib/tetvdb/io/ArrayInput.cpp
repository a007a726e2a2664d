// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/core/Error.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/io/volume/arrays/ArrayVolume.h"

#include <memory>
#include <vector>

namespace tetvdb {

namespace {

void readPages(const Source& first, const std::vector<std::string>& paths, const ArraySink& sink,
               Progress& progress) {
  std::vector<std::unique_ptr<MappedFile>> files;
  std::vector<Source> sources{first};
  for (const std::string& path : paths) {
    files.push_back(std::make_unique<MappedFile>(path));
    sources.push_back(files.back()->source());
  }
  for (const Source& source : sources)
    if (sniffFormat(source.bytes, source.path) != FileFormat::Tiff)
      throw Error(Status::Usage, source.path,
                  "is no .tif file, and several files are read as pages of one stack",
                  "name one file");
  readTiffs(sources, sink, progress);
}

} // namespace

Volume readArrays(const std::string& path, const ArrayInput& options, Progress& progress) {
  const MappedFile file(path);
  const Format& format = formatOf(sniffFormat(file.bytes(), path));
  if (!can(format, FormatUse::ReadArrays))
    throw Error(Status::Invalid, path,
                "is no file of arrays: neither " + endingList(FormatUse::ReadArrays, "nor"));
  ArrayVolume volume(path, options, progress);
  if (options.pages.empty())
    format.readArrays(file.source(), volume.sink(), progress);
  else
    readPages(file.source(), options.pages, volume.sink(), progress);
  return volume.finish();
}

} // namespace tetvdb
