// SPDX-License-Identifier: Apache-2.0
//
// Subjects side by side at one scale, with captions and a legend.
//
//   std::vector<tetvdb::PictureMaker::CaptionedSubject> subjects;
//   subjects.push_back({tetvdb::subjectOf(std::move(mesh), look), "part.stl"});
//   tetvdb::PictureMaker maker(std::move(subjects), options, progress);
//   tetvdb::writePng("part.png", maker.take(0, progress));
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/visualize/Renderer.h"
#include "tetvdb/visualize/Subject.h"

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Where a subject is cut open: the part on the eye's side of the plane goes away.
struct Cut {
  std::size_t axis = 0;
  double at = 0.5;
  bool inUnits = false; ///< `at` is a coordinate; false: a share of the box, 0 to 1
};

struct PictureOptions {
  int width = 0, height = 0; ///< 0: 640 x 480 for each subject
  std::string view = "iso";  ///< as viewNamed()
  Vec3d worldUp{0, 0, 1};    ///< z or y
  Lens lens;
  std::optional<Cut> cut;
  std::string colorMap; ///< as ColorMap::named(); empty: the one that suits the values
  std::optional<std::array<double, 2>> range; ///< of the colours; none: that of all values
  Pixel backgroundTop{0.74F, 0.79F, 0.86F, 1}, backgroundBottom{0.98F, 0.98F, 0.98F, 1};
  bool captions = false;     ///< also below a subject that is alone
  std::size_t turntable = 1; ///< the framing has room for so many pictures of a full turn
  RenderOptions render;
};

class PictureMaker {
public:
  struct CaptionedSubject {
    std::unique_ptr<Subject> subject;
    std::string caption;
  };

  /// Draws all subjects. All share one scale of colours; those whose values have other names or
  /// are of another kind are Error(Usage), and so are ranges and options that mean nothing. Throws
  /// Error(Limit) for pictures of more than 2^28 pixels.
  PictureMaker(std::vector<CaptionedSubject> subjects, const PictureOptions& options,
               Progress& progress);

  /// The subjects turned by so many parts of a full turn about the axis that points up.
  Image take(double turn, Progress& progress) const;

  int width() const { return width_; }
  int height() const { return height_; }
  const std::optional<ColorScale>& scale() const { return scale_; }
  /// Of each subject.
  const std::vector<Drawn>& drawn() const { return drawn_; }

private:
  void arrange();
  void chooseScale(const std::vector<CaptionedSubject>& subjects);
  void findFraming();
  Framing framingOfTurn(const Scene& scene) const;

  PictureOptions options_;
  View view_;
  int width_ = 0, height_ = 0, columns_ = 1, rows_ = 1;
  int cellWidth_ = 0, cellHeight_ = 0;
  std::optional<ColorScale> scale_;
  std::vector<Drawn> drawn_;
  std::vector<Scene> scenes_;
  std::vector<std::string> captions_;
  std::vector<Framing> framings_; ///< of each subject
};

} // namespace tetvdb
