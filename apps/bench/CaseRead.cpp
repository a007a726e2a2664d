// SPDX-License-Identifier: Apache-2.0
//
// readCells() and splitCells() against what reading the bytes costs at least: case read.
#include "Cases.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/mesh/SplitCells.h"

#include <charconv>
#include <cstdio>
#include <filesystem>
#include <fmt/format.h>
#include <memory>
#include <stdexcept>
#include <string_view>

namespace tetvdb::bench {
namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

File openFile(const std::string& path) {
  File file(std::fopen(path.c_str(), "rb"), &std::fclose);
  if (!file)
    throw std::runtime_error("cannot open " + path);
  return file;
}

/// The bytes through one buffer of a megabyte; returns a sum, so that they are looked at.
std::size_t readThrough(const std::string& path) {
  const File file = openFile(path);
  std::vector<char> buffer(1 << 20);
  std::size_t sum = 0;
  for (std::size_t got = 1; got > 0;) {
    got = std::fread(buffer.data(), 1, buffer.size(), file.get());
    for (std::size_t i = 0; i < got; i += 64)
      sum += static_cast<unsigned char>(buffer[i]);
  }
  return sum;
}

/// The bytes into memory of their own, as a mesh has to be.
std::unique_ptr<char[]> readWhole(const std::string& path, std::size_t& size) {
  const File file = openFile(path);
  size = std::filesystem::file_size(path);
  std::unique_ptr<char[]> bytes(new char[size]);
  if (std::fread(bytes.get(), 1, size, file.get()) != size)
    throw std::runtime_error("cannot read " + path);
  return bytes;
}

/// Numbers after numbers by std::from_chars, into vectors; words are skipped.
class PlainParser {
public:
  PlainParser(const char* at, const char* end) : at_(at), end_(end) {}

  template <typename T>
  T number() {
    skipSpace();
    T value{};
    const auto result = std::from_chars(at_, end_, value);
    if (result.ec != std::errc())
      throw std::runtime_error("no number");
    at_ = result.ptr;
    return value;
  }
  std::string_view word() {
    skipSpace();
    const char* start = at_;
    while (at_ != end_ && static_cast<unsigned char>(*at_) > ' ')
      ++at_;
    return {start, static_cast<std::size_t>(at_ - start)};
  }

private:
  void skipSpace() {
    while (at_ != end_ && static_cast<unsigned char>(*at_) <= ' ')
      ++at_;
  }
  const char* at_;
  const char* end_;
};

/// A Medit file as writeTetMesh() makes it; returns the number of tets.
std::size_t parseMedit(const std::string& path) {
  std::size_t size = 0;
  const std::unique_ptr<char[]> bytes = readWhole(path, size);
  PlainParser parser(bytes.get(), bytes.get() + size);
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> tets;
  for (std::string_view word = parser.word(); !word.empty(); word = parser.word()) {
    if (word == "Vertices") {
      points.resize(parser.number<std::size_t>());
      for (Vec3d& p : points) {
        for (double& c : p)
          c = parser.number<double>();
        parser.number<int>();
      }
    } else if (word == "Tetrahedra") {
      tets.resize(4 * parser.number<std::size_t>());
      for (std::size_t t = 0; t < tets.size(); t += 4) {
        for (std::size_t k = 0; k < 4; ++k)
          tets[t + k] = parser.number<std::uint32_t>() - 1;
        parser.number<int>();
      }
    }
  }
  return tets.size() / 4;
}

std::size_t readOurs(const std::string& path) {
  Report report;
  Progress progress;
  CellMesh cells = readCells(path, {}, report, progress);
  return splitCells(std::move(cells), {}, report, progress).tetCount();
}

} // namespace

void runRead(const Setup& setup, Tables& tables) {
  tables.begin("read",
               "readCells() and splitCells(), to a TetMesh, from files in the page cache. "
               "Peers on one thread: fread through one buffer of 1 MB, fread into new memory of "
               "the file's size, and for ASCII that followed by std::from_chars of every "
               "number. The target is half (within twice the time), or seconds.");
  const TetMesh mesh = blockMesh(1e7 / setup.shrink);
  const std::size_t tetCount = mesh.tetCount();
  volatile std::size_t sink = 0; // keeps what the peers read from being optimised away
  for (const char* name : {"block.msh", "block.vtu", "block.mesh"}) {
    const std::string path = setup.folder + "/" + name;
    {
      Progress progress;
      writeTetMesh(path, mesh, progress);
    }
    const bool ascii = std::string_view(name) == "block.mesh";
    std::vector<Rival> rivals = {
        {"ours",
         [&] {
           return secondsOf([&] {
             if (readOurs(path) != tetCount)
               throw std::runtime_error(path + ": not all tets were read");
           });
         }},
        {"fread", [&] { return secondsOf([&] { sink = readThrough(path); }); }},
        {"fread into new memory", [&] {
           return secondsOf([&] {
             std::size_t size = 0;
             sink = static_cast<unsigned char>(readWhole(path, size)[0]);
           });
         }}};
    if (ascii)
      rivals.push_back({"fread + from_chars", [&] {
                          return secondsOf([&] {
                            if (parseMedit(path) != tetCount)
                              throw std::runtime_error(path + ": the plain parser is wrong");
                          });
                        }});
    const std::vector<Times> times = interleave(rivals, setup.rounds(5), true);
    const auto fileSize = static_cast<double>(std::filesystem::file_size(path));
    for (std::size_t i = 1; i < rivals.size(); ++i) {
      Row row;
      row.what = fmt::format("{} tets, {}{}", countName(double(tetCount)), name + 5,
                             ascii ? " ASCII" : " binary");
      row.peerName = rivals[i].name;
      row.ours = times[0];
      row.peer = times[i];
      // A row for each target: seconds for binary files, half of what bytes and numbers take else.
      if (ascii && i == 3)
        row.targetRatio = 0.5;
      else if (!ascii && i == 1)
        row.targetSeconds = 5;
      else if (!ascii)
        row.targetRatio = 0.5;
      row.floorBytes = floorBytes(mesh, fileSize);
      if (i == 1)
        row.note = "file " + size(fileSize);
      tables.add(row);
    }
    std::filesystem::remove(path);
  }
  tables.end();
}

} // namespace tetvdb::bench
