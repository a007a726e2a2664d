// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/voxelize/TrimFaces.h"

#include "tetvdb/core/ForEachIndex.h"
#include "tetvdb/geometry/BoxBlocks.h"
#include "tetvdb/geometry/LatticePlane.h"
#include "tetvdb/surface/FaceContacts.h"
#include "tetvdb/surface/TrimChain.h"
#include "tetvdb/voxelize/WeldBoundary.h"

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace tetvdb {
namespace {

// Whether a winding number is inside by the rule.
bool (*insideTest(FillRule rule))(std::int64_t) {
  switch (rule) {
  case FillRule::Positive:
    return [](std::int64_t winding) { return winding > 0; };
  case FillRule::NonZero:
    return [](std::int64_t winding) { return winding != 0; };
  default:
    return [](std::int64_t winding) { return winding % 2 != 0; };
  }
}

} // namespace

TrimmedFaces trimFaces(const SnappedMesh& mesh, const Boundary& boundary, FillRule rule,
                       Progress& progress) {
  TrimmedFaces trimmed;
  WeldedFaces welded = weldFaces(mesh, boundary, progress);
  if (welded.extent > kMaxPlaneExtent) {
    trimmed.complete = false;
    return trimmed;
  }
  TrimmedChain chain = trimChain(welded, insideTest(rule), progress);
  if (chain.hasEqualFaces) {
    mergeEqualFaces(welded);
    chain = trimChain(welded, insideTest(rule), progress);
  }
  trimmed.complete = chain.complete;
  TrimCounts& counts = trimmed.counts;
  counts.met = countWhere(chain.isMet.size(), [&](std::size_t i) { return chain.isMet[i] != 0; });
  if (!trimmed.complete)
    return trimmed;
  counts.removed = welded.cancelled;
  counts.removed += countWhere(chain.fates.size(),
                               [&](std::size_t i) { return chain.fates[i] == PartFate::Goes; });
  counts.cut = chain.parts.size();
  for (const auto& [face, parts] : chain.parts)
    counts.pieces += parts.size();
  trimmed.changed = counts.cut + counts.removed > 0;
  if (!trimmed.changed)
    return trimmed;

  SnappedMesh& out = trimmed.mesh;
  const auto add = [&](const Vec3d& p) {
    out.points.push_back({welded.first.x + std::round(p[0]), welded.first.y + std::round(p[1]),
                          welded.first.z + std::round(p[2])});
  };
  for (const Vec3d& p : welded.points)
    add(p);
  for (std::size_t i = 0; i < welded.faces.size(); ++i) {
    const std::array<std::uint32_t, 3>& c = welded.faces[i].corners;
    if (chain.stays(i))
      trimmed.faces.faces.push_back({c[0], c[1], c[2], 1});
    if (!chain.isCut(i))
      continue;
    for (const FacePart& part : chain.parts.at(static_cast<std::uint32_t>(i))) {
      const auto first = static_cast<std::uint32_t>(out.points.size());
      for (const Vec3d& p : part.outline)
        add(p);
      for (std::uint32_t k = 2; k < part.outline.size(); ++k)
        trimmed.faces.faces.push_back({first, first + k - 1, first + k, 1});
    }
  }
  out.pointCount = out.points.size();
  out.points.push_back({0, 0, 0});
  out.boxMin = mesh.boxMin;
  out.boxMax = mesh.boxMax;
  return trimmed;
}

std::size_t countMetFaces(const SnappedMesh& mesh, const Boundary& boundary, Progress& progress) {
  WeldedFaces welded = weldFaces(mesh, boundary, progress);
  FaceContacts contacts = findContacts(welded, faceBoxes(welded), progress);
  if (contacts.equal) {
    mergeEqualFaces(welded);
    contacts = findContacts(welded, faceBoxes(welded), progress);
  }
  if (!contacts.complete)
    return welded.faces.size();
  std::size_t met = 0;
  for (std::size_t i = 0; i < welded.faces.size(); ++i)
    met += contacts.isMet(i);
  return met;
}

} // namespace tetvdb
