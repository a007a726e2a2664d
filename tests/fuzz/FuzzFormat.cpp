// SPDX-License-Identifier: Apache-2.0
//
// What the libFuzzer programs of all formats do with their input. The reader is that of the table
// of formats; the bytes are all that it gets, since a file of that name does not exist.
#include "FuzzFormat.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/formats/ensight/EnsightReader.h"
#include "tetvdb/io/formats/openfoam/OpenFoamReader.h"
#include "tetvdb/io/formats/tetgen/TetGenReader.h"
#include "tetvdb/io/formats/threemf/ThreeMfModel.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/arrays/ArrayReaders.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/TriangleMesh.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

namespace tetvdb {
namespace {

/// Reads the first and the last number of every axis of an array.
ArraySink touchingSink() {
  ArraySink sink;
  sink.array = [](const StoredArray& array) {
    for (unsigned corner = 0; corner < 16; ++corner) {
      std::uint64_t at = corner >> 3 != 0 ? (array.components - 1) * array.componentStep : 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (array.size[k] == 0)
          return;
        at += (corner >> k & 1) != 0 ? (array.size[k] - 1) * array.step[k] : 0;
      }
      if (array.components == 0)
        return;
      const volatile char last = array.bytes.at((at + 1) * bytesOf(array.element) - 1);
      static_cast<void>(last);
    }
    if (!array.coordinates.empty() && array.coordinates.size() != 12 * array.size[0])
      std::abort();
  };
  sink.leftOut = [](const std::string&, const std::string&) {};
  sink.metadata = sink.leftOut;
  return sink;
}

/// What the target works on in place of the reader of the table, where the bytes of a file would
/// hide from the fuzzer what matters. Whether it did.
bool readInsteadOfFile(std::string_view bytes, Report& report, Progress& progress) {
  if (kFuzzedFormat == FileFormat::TetGen) { // the two files in one input, parted by a '|'
    const std::size_t bar = std::min(bytes.find('|'), bytes.size());
    const Source node{bytes.substr(0, bar), "fuzz.node"};
    const Source ele{bytes.substr(std::min(bar + 1, bytes.size())), "fuzz.ele"};
    splitCells(readTetGenPair(node, ele, {}, report, progress), {}, report, progress);
    return true;
  }
  if (kFuzzedFormat == FileFormat::Raw) { // the header and the numbers, likewise
    const std::size_t bar = std::min(bytes.find('|'), bytes.size());
    readRawArrays(bytes.substr(0, bar), "fuzz.raw.json",
                  {bytes.substr(std::min(bar + 1, bytes.size())), "fuzz.raw"}, touchingSink());
    return true;
  }
  if (kFuzzedFormat == FileFormat::Ensight && sniffFormat(bytes, "fuzz.geo") != kFuzzedFormat) {
    splitCells(ensight::readGeometry({bytes, "fuzz.geo"}, {}, progress), {}, report, progress);
    return true;
  }
  if (kFuzzedFormat == FileFormat::OpenFoam) { // a case is a folder of files
    splitCells(openfoam::readTexts(bytes, report, progress), {}, report, progress);
    return true;
  }
  if (kFuzzedFormat == FileFormat::ThreeMf &&
      bytes.substr(0, 1) != "P") { // a model without its archive
    parseThreeMfModel(bytes, "fuzz", progress);
    return true;
  }
  return false;
}

void readFile(std::string_view bytes) {
  const Source source{bytes, "/nonexistent/folder/fuzz"};
  const Format& format = formatOf(kFuzzedFormat);
  Report report;
  Progress progress;
  if (readInsteadOfFile(bytes, report, progress))
    return;
  if (format.readTriangles != nullptr) {
    try {
      const TriangleMesh mesh = format.readTriangles(source, report, progress);
      for (const std::uint32_t corner : mesh.triangles)
        if (corner >= mesh.points.size())
          std::abort();
    } catch (const Error&) {
      if (format.readCells == nullptr)
        throw;
    }
  }
  if (format.readArrays != nullptr)
    format.readArrays(source, touchingSink(), progress);
  if (format.hasSolidCells != nullptr) {
    try {
      format.hasSolidCells(source, report, progress);
    } catch (const Error&) {
    }
  }
  if (format.readTimes != nullptr)
    format.readTimes(source, report, progress);
  if (format.readCells != nullptr)
    splitCells(format.readCells(source, {}, report, progress), {}, report, progress);
}

} // namespace
} // namespace tetvdb

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tetvdb::readFile({reinterpret_cast<const char*>(data), size});
  } catch (const tetvdb::Error&) {
  }
  return 0;
}
