// SPDX-License-Identifier: Apache-2.0
//
// Meshes (and what else there may be) as subjects of pictures: all that can be asked before they
// are turned into things to draw, so that several can share a scale of colours and a cut.
//
//   tetvdb::MeshLook look;
//   look.color = "quality";
//   std::unique_ptr<tetvdb::Subject> subject = tetvdb::subjectOf(std::move(tets), look);
//   tetvdb::PictureMaker maker(...);                      // visualize/PictureMaker.h
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/visualize/ColorMap.h"
#include "tetvdb/visualize/CutPlane.h"
#include "tetvdb/visualize/Drawable.h"
#include "tetvdb/visualize/TriangleDrawable.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// What a subject has become.
struct Drawn {
  std::vector<std::shared_ptr<const Drawable>> drawables;
  std::vector<std::shared_ptr<const Medium>> media;
  std::size_t triangles = 0; ///< that were made to be drawn
  std::size_t cutTets = 0;   ///< shown by themselves
  /// Counted where the look asks for defects.
  std::size_t openEdges = 0, nonManifoldEdges = 0, flippedFaces = 0;
};

/// One drawable subject, in memory. Called by one thread at a time.
class Subject {
public:
  virtual ~Subject() = default;
  /// World units; of all of it, whatever a cut takes away.
  virtual Box bounds() const = 0;
  /// What its colours mean, by its own values and with the map that suits them; nothing: it has
  /// one colour.
  virtual std::optional<ColorScale> scale() const { return std::nullopt; }
  /// Turns it into things to draw, with the colours of `scale` where it has values. Called once:
  /// what it holds is given away or freed.
  virtual Drawn draw(const ColorScale* scale, const std::optional<CutPlane>& cut,
                     Progress& progress) = 0;
};

struct MeshLook {
  /// "": one colour; "quality": the AMIPS energy of tets; "region" or "material": their regions;
  /// else what FieldRequest::array takes, vectors and other tuples by their length.
  std::string color;
  bool wire = false, smooth = false;
  bool defects = false; ///< of triangles: open and non-manifold edges, flipped faces
  double shrink = 0.85; ///< of tets that a cut meets
  Rgb plain{0.60F, 0.62F, 0.65F};
};

/// Throws Error(Usage) for colours: triangles have no values.
std::unique_ptr<Subject> subjectOf(TriangleMesh mesh, const MeshLook& look);
/// Throws Error(Usage) for an array or regions that the mesh does not have, and for defects.
std::unique_ptr<Subject> subjectOf(TetMesh mesh, const MeshLook& look);

} // namespace tetvdb
