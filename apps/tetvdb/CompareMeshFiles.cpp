// SPDX-License-Identifier: Apache-2.0
#include "CompareMeshFiles.h"

#include "JsonReport.h"
#include "NumberText.h"
#include "tetvdb/pipeline/JobFiles.h"
#include "tetvdb/pipeline/ReadInput.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/TetSurface.h"
#include "tetvdb/visualize/WritePng.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace tetvdb::cli {
namespace {

using Json = nlohmann::ordered_json;

// Meshes nearer than this times the diagonal count as equal: text files round that much.
constexpr double kSame = 1e-9;

TriangleMesh readSurface(const std::string& path, Session& session) {
  InputInfo info;
  TriangleMesh mesh;
  if (holdsTriangles(path)) {
    mesh = readSoup(path, &info, session.report, session.progress);
  } else {
    ReadOptions options;
    options.attributes = false;
    mesh = tetSurface(readTets(path, options, {}, &info, session.report, session.progress),
                      session.progress);
  }
  session.sections["input"].push_back({{"path", path},
                                       {"format", formatName(info.format)},
                                       {"kind", info.tets > 0 ? "tets" : "triangles"},
                                       {"vertices", info.vertices},
                                       {"surface_triangles", mesh.triangleCount()}});
  return mesh;
}

Json distanceSection(const OneSidedDistance& distance) {
  return {{"mean", distance.mean},
          {"rms", distance.rms},
          {"largest", distance.largest},
          {"where", distance.where}};
}

std::string distanceText(const char* way, const OneSidedDistance& distance, double diagonal) {
  return fmt::format("{}: mean {:.6g}, root mean square {:.6g}, largest {:.6g} at {}\n", way,
                     distance.mean, distance.rms, distance.largest,
                     pointText(distance.where, diagonal));
}

} // namespace

ComparedNames namesOf(const std::string& a, const std::string& b) {
  return {std::filesystem::path(a).filename().string(),
          std::filesystem::path(b).filename().string()};
}

void writeComparison(const Image& picture, const std::string& output, Session& session) {
  writePng(output, picture);
  const OutputInfo info = written(output);
  session.sections["output"] = {{{"path", info.path}, {"bytes", info.bytes}}};
}

void compareMeshFiles(const std::string& a, const std::string& b, double tolerance,
                      const std::string& output, Session& session) {
  session.sections["input"] = Json::array();
  session.progress.stage("read");
  const TriangleMesh first = readSurface(a, session), second = readSurface(b, session);
  session.progress.stage("compare");
  const MeshDistance distance = compareMeshes(first, second, {}, session.progress);
  const bool same = distance.hausdorff <= std::max(tolerance, kSame * distance.diagonal);
  session.sections["compare"] = {{"same", same},
                                 {"a_to_b", distanceSection(distance.aToB)},
                                 {"b_to_a", distanceSection(distance.bToA)},
                                 {"hausdorff", distance.hausdorff},
                                 {"diagonal", distance.diagonal},
                                 {"samples", distance.aToB.points + distance.bToA.points}};
  session.text =
      distanceText("A to B", distance.aToB, distance.diagonal) +
      distanceText("B to A", distance.bToA, distance.diagonal) +
      fmt::format("Hausdorff distance {:.6g}, {:.3g} of the diagonal {:.6g}\n", distance.hausdorff,
                  distance.hausdorff / distance.diagonal, distance.diagonal) +
      (same ? "same\n" : "different\n");
  session.textIsSummary = true;
  if (!output.empty()) {
    session.progress.stage("draw");
    writeComparison(comparePicture(first, second, namesOf(a, b), session.progress), output,
                    session);
  }
  if (!same)
    session.status = Status::Found;
}

} // namespace tetvdb::cli
