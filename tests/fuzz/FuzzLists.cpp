// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer program for files that name others: .pvd, a sequence's, and .pvtu, a mesh's in pieces.
// The piece "piece.vtu" is there, a tet.
#include "tetvdb/core/Error.h"
#include "tetvdb/io/formats/vtk/PvtuReader.h"
#include "tetvdb/io/source/ReferredFiles.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/pipeline/FindFrames.h"

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <string_view>
#include <unistd.h>

namespace {

const char* const kPiece = R"(<?xml version="1.0"?>
<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian">
<UnstructuredGrid><Piece NumberOfPoints="4" NumberOfCells="1">
<PointData><DataArray type="Float64" Name="t" format="ascii">1 2 3 4</DataArray></PointData>
<Points><DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points>
<Cells><DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3</DataArray>
<DataArray type="Int64" Name="offsets" format="ascii">4</DataArray>
<DataArray type="UInt8" Name="types" format="ascii">10</DataArray></Cells>
</Piece></UnstructuredGrid></VTKFile>
)";

/// Of this process; it stays when a sanitizer ends it.
std::string folder() {
  static const std::string path = [] {
    const std::string made = "/dev/shm/tetvdb-fuzz-" + std::to_string(::getpid());
    std::filesystem::create_directories(made);
    std::ofstream(made + "/piece.vtu") << kPiece;
    std::atexit([] {
      std::error_code ignored;
      std::filesystem::remove_all("/dev/shm/tetvdb-fuzz-" + std::to_string(::getpid()), ignored);
    });
    return made;
  }();
  return path;
}

void attempt(const std::function<void(tetvdb::Report&, tetvdb::Progress&)>& read) {
  tetvdb::Report report;
  tetvdb::Progress progress;
  try {
    read(report, progress);
  } catch (const tetvdb::Error&) {
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tetvdb;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const std::string list = folder() + "/list.pvd";
  std::ofstream(list, std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
  attempt([&](Report& report, Progress& progress) {
    for (const Frame& frame : findFrames({list}, {}, false, report, progress))
      if (frame.inputs.empty())
        std::abort();
  });
  referredFiles(list);
  const Source source{bytes, folder() + "/list.pvtu"};
  attempt([&](Report& report, Progress& progress) {
    splitCells(readPvtu(source, {}, report, progress), {}, report, progress);
  });
  attempt([&](Report& report, Progress& progress) { pvtuHasSolidCells(source, report, progress); });
  return 0;
}
