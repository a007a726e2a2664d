// SPDX-License-Identifier: Apache-2.0
//
// The input and results of a job side by side in one picture: --preview.
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

/// Throws the errors of a preview's path before the work starts, as for other outputs; an empty
/// path is accepted.
void checkPreviewPath(const std::string& path);

/// Panels are drawn as soon as their data is available, since jobs release it. Each uses a copy of
/// its mesh while it is drawn, and adds to stage "preview". All views are from the front, right and
/// above, with z up, or y up if the output has y up.
class Preview {
public:
  explicit Preview(bool yUp = false) : yUp_(yUp) {}

  /// With open edges in red, non-manifold ones in yellow, flipped faces in blue.
  void input(const TriangleMesh& mesh, Report& report, Progress& progress);
  /// A surface made by the job, with its defects.
  void surface(const TriangleMesh& mesh, const std::string& panel, Report& report,
               Progress& progress);
  /// Cut open at the centre, cells coloured by quality.
  void tets(const TetMesh& mesh, Report& report, Progress& progress);
  /// The volume's main grid as a solid, a slice through its centre, and the same slice of every
  /// other grid that is not a shape: arrays, materials, numbers of tets. At most the first six,
  /// with the warning "preview-arrays".
  void volume(const Volume& volume, Report& report, Progress& progress);

  bool isEmpty() const { return panels_.empty(); }
  PreviewInfo info() const;
  /// Writes all panels in a row, as a PNG; nothing if there are none. Throws Error(Write).
  void write(const std::string& path) const;
  /// The same for a job whose only other output is already written: if the picture fails, that
  /// output is removed too. Does nothing if there are no panels.
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
