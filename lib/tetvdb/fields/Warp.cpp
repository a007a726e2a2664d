// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/fields/Warp.h"

#include "tetvdb/core/ClosestName.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/fields/Field.h"

#include <cmath>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace tetvdb {

void warpPoints(TetMesh& mesh, const Warp& warp) {
  if (warp.array.empty())
    return;
  FieldOptions options;
  options.requests = {{"", warp.array, FieldPart::Whole, ""}};
  Report told; // points without a finite vector, refused below
  std::vector<Field> fields;
  try {
    fields = resolveFields(mesh, options, told);
  } catch (const Error& error) {
    if (error.status() != Status::Usage)
      throw;
    throw Error(Status::Usage, "`warp`", "the mesh has no array '" + warp.array + "'",
                suggestName(warp.array, arrayNames(mesh),
                            mesh.attributes.empty() && mesh.unread.empty()
                                ? "it has no arrays"
                                : "its arrays are " + describeArrays(mesh)));
  }
  const Field& field = fields.front();
  if (field.kind != FieldKind::Vector || field.on != Attribute::On::Points)
    throw Error(Status::Usage, "`warp`",
                "the array '" + warp.array + "' does not have a vector for every point",
                "its arrays are " + describeArrays(mesh));
  if (field.notFinite > 0)
    throw Error(Status::Invalid, "`warp`",
                "the array '" + warp.array + "' has no finite vector at " +
                    std::to_string(field.notFinite) + " points",
                "repair the file");
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, mesh.points.size(), 8192), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i)
          for (std::size_t k = 0; k < 3; ++k) {
            const double moved =
                warp.factor * field.sources[k].array->number(i, field.sources[k].component);
            // Points in use have finite vectors; others do not move.
            if (std::isfinite(moved))
              mesh.points[i][k] += moved;
          }
      });
}

} // namespace tetvdb
