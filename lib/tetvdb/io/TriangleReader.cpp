// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/TriangleReader.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Source.h"

#include <new>

namespace tetvdb {
bool holdsTriangles(FileFormat format) {
  const Format& row = formatOf(format);
  return row.readTriangles != nullptr && row.readCells == nullptr;
}

bool holdsTriangles(const Source& source, Progress& progress) try {
  const Format& format = formatOf(sniffFormat(source.bytes, source.path));
  if (format.readTriangles == nullptr || format.readCells == nullptr)
    return format.readTriangles != nullptr;
  Report unused; // the same warnings as those of the mesh
  return !format.hasSolidCells(source, unused, progress);
} catch (const Error& error) {
  if (error.status() == Status::Cancelled)
    throw;
  return false;
}

TriangleMesh readTriangles(const std::string& path, Report& report, Progress& progress,
                           FileFormat* format) {
  const MappedFile file(path);
  const Source source = file.source();
  const FileFormat found = sniffFormat(source.bytes, path);
  if (format != nullptr)
    *format = found;
  const auto read = formatOf(found).readTriangles;
  if (read == nullptr)
    throw Error(Status::Invalid, path, describeUnknownFormat(source.bytes, path),
                "readable are " + endingList(FormatUse::ReadTriangles, "and"));
  try {
    return read(source, report, progress);
  } catch (const std::bad_alloc&) {
    throw Error(Status::Limit, path, "not enough memory to read the mesh",
                "split it into several files or use a machine with more memory");
  }
}

} // namespace tetvdb
