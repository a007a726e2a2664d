// SPDX-License-Identifier: Apache-2.0
//
// Triangles put through the mesher as a user would, and what must hold of every result.
#pragma once

#include "TriangleMeshes.h"
#include "tetrahedralize/TetMeshCheck.h"
#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"

#include <cmath>
#include <gtest/gtest.h>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

struct MadeTets {
  Tetrahedralization result;
  std::vector<TriangleMesh> cleaned;
  Report report;
  std::optional<Status> error; ///< then there are no tets
  std::string message;
};

inline MadeTets madeTets(std::vector<TriangleMesh> inputs, const TetrahedralizeOptions& options) {
  MadeTets made;
  Progress progress;
  for (TriangleMesh& mesh : inputs)
    cleanTriangles(mesh, {}, progress);
  made.cleaned = std::move(inputs);
  try {
    made.result = tetrahedralize(made.cleaned, options, made.report, progress);
  } catch (const Error& error) {
    made.error = error.status();
    made.message = error.what();
    EXPECT_FALSE(made.message.empty());
    EXPECT_EQ(made.message.find('\n'), std::string::npos) << made.message;
  }
  return made;
}

inline double areaOf(const TriangleMesh& mesh) {
  double sum = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); i += 3) {
    const Vec3d& a = mesh.points[mesh.triangles[i]];
    sum += length(cross(minus(mesh.points[mesh.triangles[i + 1]], a),
                        minus(mesh.points[mesh.triangles[i + 2]], a))) /
           2;
  }
  return sum;
}

/// Nothing invalid, and the surface where it should be. Where the input is open the winding number
/// changes from place to place, and tets that are not cut along 0.5 may be some way off it: a
/// thirtieth of the points.
inline void expectNoFaults(TetMeshCheck check) {
  const std::size_t few = check.closedInput ? 0 : 1;
  EXPECT_LE(30 * check.wrongPoints, few * check.windingPoints) << check.json();
  EXPECT_LE(30 * check.lostPoints, few * (check.judgedFarPoints + 4000)) << check.json();
  check.wrongPoints = 0;
  EXPECT_EQ(check.faults(), "") << check.json();
}

inline TetMeshCheck checkOf(const MadeTets& made) {
  return checkTetMesh(made.result.mesh, made.cleaned[0], made.result.epsilonAsked,
                      {4000, 400, 4000, 1});
}

/// Judged by checkTetMesh(); all faces in, and nothing warned of but what a hole brings with it.
/// `volume` of the solid, if known: what is off by less than the surface can move within epsilon is
/// right.
inline MadeTets expectSolid(const TriangleMesh& mesh, std::optional<double> volume = {},
                            const TetrahedralizeOptions& options = {}) {
  MadeTets made = madeTets({mesh}, options);
  EXPECT_FALSE(made.error) << made.message;
  if (made.error)
    return made;
  const TetMeshCheck check = checkOf(made);
  expectNoFaults(check);
  EXPECT_EQ(made.result.notInserted, 0u);
  for (const Warning& warning : made.report.warnings)
    EXPECT_TRUE(!check.closedInput && warning.code == "lost-surface") << warning.text;
  if (volume) {
    EXPECT_NEAR(check.volume, *volume, areaOf(made.cleaned[0]) * made.result.epsilonAsked);
  }
  return made;
}

} // namespace tetvdb
