// SPDX-License-Identifier: Apache-2.0
//
// writeVolume() against openvdb::io::File: cases write and write5m.
#include "Cases.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/volume/Grids.h"

#include <cmath>
#include <fcntl.h>
#include <filesystem>
#include <fmt/format.h>
#include <openvdb/io/File.h>
#include <openvdb/tree/LeafManager.h>
#include <unistd.h>

namespace tetvdb::bench {
namespace {

enum class Content {
  Fog,  ///< half of each leaf active with value 1, as the leaves of a density
  Field ///< all active, values as of a smooth simulation result
};

/// A block of about `leaves` leaves.
openvdb::FloatGrid::Ptr makeGrid(double leaves, Content content) {
  const int side = static_cast<int>(std::ceil(std::cbrt(leaves)));
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName(content == Content::Fog ? "density" : "temperature");
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y)
      for (int z = 0; z < side; ++z)
        grid->tree().addLeaf(
            new openvdb::FloatTree::LeafNodeType(openvdb::Coord(8 * x, 8 * y, 8 * z), 0.0f, false));
  openvdb::tree::LeafManager<openvdb::FloatTree> manager(grid->tree());
  manager.foreach ([&](openvdb::FloatTree::LeafNodeType& leaf, std::size_t) {
    const openvdb::Coord origin = leaf.origin();
    // A plane through the leaf, tilted by where the leaf lies.
    const int tilt = 1 + (origin.x() / 8 + 3 * (origin.y() / 8) + 5 * (origin.z() / 8)) % 7;
    for (openvdb::Index i = 0; i < openvdb::FloatTree::LeafNodeType::SIZE; ++i) {
      const openvdb::Coord at = leaf.offsetToGlobalCoord(i);
      if (content == Content::Field)
        leaf.setValueOn(i, std::sin(0.011f * float(at.x())) * std::cos(0.013f * float(at.y())) +
                               0.001f * float(at.z()));
      else if ((at.x() & 7) * tilt + (at.y() & 7) * (8 - tilt) + (at.z() & 7) * 3 < 39)
        leaf.setValueOn(i, 1.0f);
    }
  });
  return grid;
}

void sync(const std::string& path) {
  const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (file >= 0) {
    fsync(file);
    close(file);
  }
}

void compareWriters(double leaves, Content content, double target, int rounds, const Setup& setup,
                    Tables& tables) {
  initializeOpenVDB();
  const openvdb::FloatGrid::Ptr grid = makeGrid(leaves / setup.shrink, content);
  auto set = std::make_shared<GridSet>();
  set->all = {grid};
  const Volume volume(set);
  const std::string ours = setup.folder + "/ours.vdb", theirs = setup.folder + "/theirs.vdb";
  double oursSize = 0, theirSize = 0;
  const auto sizeOf = [](const std::string& path) {
    return static_cast<double>(std::filesystem::file_size(path));
  };
  const auto runOurs = [&] {
    Progress progress;
    const double seconds = secondsOf([&] { writeVolume(ours, volume, progress); });
    oursSize = sizeOf(ours);
    std::filesystem::remove(ours);
    return seconds;
  };
  // Ours syncs the file before it is renamed, so io::File's is synced, too.
  const auto runTheirs = [&](bool synced) {
    const double seconds = secondsOf([&] {
      openvdb::io::File file(theirs);
      file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
      file.write({grid});
      file.close();
      if (synced)
        sync(theirs);
    });
    theirSize = sizeOf(theirs);
    std::filesystem::remove(theirs);
    return seconds;
  };
  const std::vector<Times> times =
      interleave({{"ours", runOurs},
                  {"io::File, synced", [&] { return runTheirs(true); }},
                  {"io::File", [&] { return runTheirs(false); }}},
                 setup.rounds(rounds), rounds > 3);
  Row row;
  row.what = fmt::format("{} float leaves, {}", countName(double(grid->tree().leafCount())),
                         content == Content::Fog ? "fog" : "smooth field");
  row.peerName = "io::File, synced";
  row.ours = times[0];
  row.peer = times[1];
  row.targetRatio = target;
  row.floorBytes = static_cast<double>(grid->memUsage()) + oursSize;
  row.note = fmt::format("bytes written: ours {:.0f}, io::File {:.0f}", oursSize, theirSize);
  tables.add(row);
  row.peerName = "io::File";
  row.peer = times[2];
  row.note.clear();
  tables.add(row);
}

const char* const kAbout = "writeVolume() to .vdb (synced and renamed) against openvdb::io::File "
                           "with the same compression, Blosc with active mask, to the same disk.";

} // namespace

void runWrite(const Setup& setup, Tables& tables) {
  tables.begin("write", kAbout);
  compareWriters(1e6, Content::Fog, 2, 5, setup, tables);
  compareWriters(1e6, Content::Field, 2, 3, setup, tables);
  tables.end();
}

void runWrite5M(const Setup& setup, Tables& tables) {
  tables.begin("write5m", kAbout);
  compareWriters(5e6, Content::Fog, 2, 3, setup, tables);
  tables.end();
}

} // namespace tetvdb::bench
