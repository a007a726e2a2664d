// SPDX-License-Identifier: Apache-2.0
//
// Closes the holes of components that bound a volume by themselves.
//
//   tetvdb::cleanTriangles(mesh, {}, progress);
//   tetvdb::ClosedComponents closed = tetvdb::closeComponents(mesh, progress);
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/surface/FillHoles.h"

#include <cstddef>
#include <vector>

namespace tetvdb {

struct ClosedComponents {
  std::vector<FilledHole> holes; ///< in the order of their faces
  std::size_t faces = 0;         ///< of all of them, appended to the mesh
};

/// Appends faces over the holes of open components that bound a volume. A component is a set of
/// faces connected across edges; a plane hole of several loops, as at the end of a tube's wall,
/// joins the components of its loops.
///
/// The winding number of an open component alone is 0.5 on the plane of its only hole: closing it
/// in this plane does not change its solid. It does change what several components enclose: the
/// winding number of an open one is up to 0.5 on one side of its hole and down to -0.5 on the
/// other, which adds to that of all others there. A closed component has no such field.
///
/// Holes of a component are closed, all or none, if
/// - at sample points the component by itself encloses the same solid with these faces: less than
///   1 % of it is lost and 10 % gained, as at the ends of a tube that is long for its width;
/// - the components that stay open have a winding number between -0.25 and 0.25 at the new faces,
///   and less than 1 % of what is inside only by these and the given faces of others together is
///   lost. Elsewhere several components bound one solid together.
/// Sheets, components that are inside out and short tubes stay open. If the mesh is a single
/// component, only plane holes are closed (fillPlaneHoles()), otherwise all holes of up to 1000
/// edges in all for each component (fillHoles()). Existing points and faces do not change; new ones
/// are appended. Deterministic. The mesh is cleaned. About 0.1 ms per open component.
ClosedComponents closeComponents(TriangleMesh& mesh, Progress& progress);

} // namespace tetvdb
