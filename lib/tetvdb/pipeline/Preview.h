// SPDX-License-Identifier: Apache-2.0
//
// What a job did, side by side in one picture: --preview.
//
//   tetvdb::Preview preview;
//   preview.input(mesh, report, progress);
//   preview.tets(tets, report, progress);
//   preview.volume(volume, report, progress);
//   preview.write("part.png");
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/PreviewInfo.h"
#include "tetvdb/visualize/Image.h"
#include "tetvdb/visualize/PictureMaker.h"
#include "tetvdb/visualize/VolumeSubject.h"
#include "tetvdb/volume/Volume.h"

#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Throws what is wrong with a preview's path before any work, as for other outputs; an empty one
/// is in order.
void checkPreviewPath(const std::string& path);

/// Panels are drawn as soon as what they show is there, since jobs release it; every one takes a
/// copy of its mesh while it is drawn, and adds to stage "preview". All look from the front, right
/// and above, at z up, or y up where the output is.
class Preview {
public:
  explicit Preview(bool yUp = false) : yUp_(yUp) {}

  /// With open edges in red, non-manifold ones in yellow, flipped faces in blue.
  void input(const TriangleMesh& mesh, Report& report, Progress& progress);
  /// A surface that was made, with defects where it has any.
  void surface(const TriangleMesh& mesh, const std::string& panel, Report& report,
               Progress& progress);
  /// Cut open across the middle, cells coloured by quality.
  void tets(const TetMesh& mesh, Report& report, Progress& progress);
  /// The volume's main grid as a solid, a slice through its middle, and the same slice of every
  /// other grid that is no shape: arrays, materials, numbers of tets. Of more than six the first
  /// six, with the warning "preview-arrays".
  void volume(const Volume& volume, Report& report, Progress& progress);

  bool isEmpty() const { return panels_.empty(); }
  PreviewInfo info() const;
  /// All panels in a row, as a PNG; nothing where there are none. Throws Error(Write).
  void write(const std::string& path) const;
  /// The same for a job whose only other output is written already: where the picture fails that
  /// goes too. Nothing where there are no panels.
  std::optional<PreviewInfo> writeBeside(const std::string& output, const std::string& path) const;

private:
  void arrays(const Volume& volume, VolumeShow show, const PictureOptions& options, Report& report,
              Progress& progress);

  struct Panel {
    std::string name;
    Image image;
  };
  bool yUp_;
  std::vector<Panel> panels_;
};

} // namespace tetvdb
