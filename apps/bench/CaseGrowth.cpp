// SPDX-License-Identifier: Apache-2.0
//
// How time grows with tets and with voxels, ours and the paper's loop: cases tets and resolution.
#include "Cases.h"
#include "PaperLoop.h"

#include <cmath>
#include <fmt/format.h>
#include <map>
#include <utility>

namespace tetvdb::bench {
namespace {

constexpr std::pair<GridKind, const char*> kGrids[] = {
    {GridKind::Mask, "mask"}, {GridKind::Density, "density"}, {GridKind::TetId, "tet_id"}};

/// The power of `at` that a curve's time grows by between its first and its last point.
class Growth {
public:
  void add(const std::string& curve, double at, const Times& times) {
    if (!times.seconds.empty())
      curves_[curve].emplace_back(at, times.median());
  }
  void say(const std::string& along, Tables& tables) const {
    for (const auto& [name, points] : curves_) {
      const auto& [x0, y0] = points.front();
      const auto& [x1, y1] = points.back();
      if (points.size() > 1)
        tables.note(fmt::format("{}: as the power {:.2f} of {}, from the first to the last", name,
                                std::log(y1 / y0) / std::log(x1 / x0), along));
    }
  }

private:
  std::map<std::string, std::vector<std::pair<double, double>>> curves_;
};

/// All grids and, if asked, the loop, in turns. The last row has no peer where the loop is left
/// out.
void compare(const TetMesh& mesh, int resolution, double at, bool loopToo, const Setup& setup,
             Growth& growth, Tables& tables) {
  VoxelizeOptions options[3];
  std::vector<Rival> rivals;
  std::vector<OursResult> results(3);
  for (std::size_t k = 0; k < 3; ++k) {
    options[k].grids = {kGrids[k].first};
    options[k].resolution = resolution;
    // Values of every voxel inside: 4096^3 do not fit.
    if (kGrids[k].first != GridKind::TetId || resolution <= 1024)
      rivals.push_back(
          {kGrids[k].second, [&, k] { return timeOurs(mesh, options[k], &results[k]); }});
  }
  std::unique_ptr<PaperLoop<std::uint8_t>> loop;
  if (loopToo) {
    loop = std::make_unique<PaperLoop<std::uint8_t>>(mesh, chooseTransform(mesh, options[0]));
    rivals.push_back({"paper's loop", [&] { return secondsOf([&] { loop->run(); }); }, 3});
  }
  const std::vector<Times> times = interleave(rivals, setup.rounds(5), true);
  for (std::size_t k = 0; k + (loopToo ? 1 : 0) < rivals.size(); ++k) {
    Row row;
    row.what = fmt::format("{}, {} tets, ball, {}^3", rivals[k].name,
                           countName(static_cast<double>(mesh.tetCount())), resolution);
    row.curve = rivals[k].name;
    row.at = at;
    row.ours = times[k];
    row.peerName = "(alone)";
    row.floorBytes = floorBytes(mesh, static_cast<double>(results[k].bytes));
    if (loopToo) {
      row.peerName = row.peerCurve = "paper's loop";
      row.peer = times.back();
    }
    growth.add(row.curve, at, row.ours);
    if (k == 0)
      growth.add("paper's loop", at, row.peer);
    tables.add(row);
  }
}

} // namespace

void runTets(const Setup& setup, Tables& tables) {
  tables.begin(
      "tets",
      "Stage `voxelize` at 256^3 of balls of more and more tets, and the paper's loop "
      "(uint8). By the design a tet costs a constant where its faces are matched, and what "
      "is rasterized follows the surface; the loop pays for every tet's box.",
      "tets");
  Growth growth;
  for (const double tets : {1e4, 1e5, 1e6, 1e7}) {
    const TetMesh mesh = ballMesh(tets / setup.shrink);
    compare(mesh, shrunk(256, setup), static_cast<double>(mesh.tetCount()), true, setup, growth,
            tables);
  }
  growth.say("tets", tables);
  tables.end();
}

void runResolution(const Setup& setup, Tables& tables) {
  tables.begin("resolution",
               "Stage `voxelize` of a ball of 10^5 tets on finer and finer grids, and the paper's "
               "loop (uint8) as far as 1024^3. Masks and densities follow the surface, so four "
               "times the cost for twice the resolution; tet_id and the loop follow the volume, "
               "eight times.",
               "voxels along a side");
  Growth growth;
  const TetMesh mesh = ballMesh(1e5 / setup.shrink);
  for (const int resolution : {64, 128, 256, 512, 1024, 2048, 4096}) {
    const int side = shrunk(resolution, setup);
    compare(mesh, side, side, resolution <= 1024, setup, growth, tables);
  }
  growth.say("voxels along a side", tables);
  tables.end();
}

} // namespace tetvdb::bench
