// SPDX-License-Identifier: Apache-2.0
//
// Sets of pixels by their distance to others, and where a set is thin.
//
//   tetvdb::SpanRows thin = tetvdb::thinPixels(solid, 0.4, frame);
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/LayerComponents.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// The pixels whose centres are within `radius` millimetres (or, where it is open, nearer than
/// that) of the centre of one pixel, which need not be square: by row, how far they reach.
class PixelDisc {
public:
  PixelDisc(double pixelWidth, double pixelHeight, double radius, bool open);

  /// Rows on either side of the middle one; -1 where the disc is empty.
  std::int32_t rows() const { return static_cast<std::int32_t>(reach_.size()) - 1; }
  /// Columns on either side, of the row `dy` rows away.
  std::int32_t reach(std::int32_t dy) const {
    return reach_[static_cast<std::size_t>(dy < 0 ? -dy : dy)];
  }

private:
  std::vector<std::int32_t> reach_;
};

/// The pixels of `from` in whose disc no pixel of `other` lies. About 5 ns for each row of the
/// disc and span of a row that is left.
SpanRows withoutNear(const SpanRows& from, const SpanRows& other, const PixelDisc& disc);

/// What is not in `set`, in the rows from `margin` above its first to `margin` below its last;
/// spans reach from -kFar to kFar.
SpanRows complementOf(const SpanRows& set, std::int32_t margin);
constexpr std::int32_t kFar = 1 << 28;

/// Where a set is thinner than `limit` millimetres. A core pixel is one of the set with no other
/// pixel nearer than limit / 2; thin are the pixels of the set that are farther than `limit` from
/// every core pixel. So corners of 60 degrees and more are not thin, nor are the ends of what is as
/// wide as `limit`; of what is narrower, up to one pixel's width may pass. Distances are between
/// centres of pixels.
SpanRows thinPixels(const SpanRows& set, double limit, const LayerFrame& frame);

/// The same of what is not in the set.
SpanRows thinGaps(const SpanRows& set, double limit, const LayerFrame& frame);

/// Of each label of `part`: how wide the set is there that it is in, millimetres, up to `maxWidth`:
/// twice the distance from the middle of one of its spans to the nearest pixel of `other`, the
/// complement of that set, less a pixel, so that a row of single pixels is one pixel wide. Less
/// than a pixel too small.
std::vector<double> widthsOf(const LabelledSpans& part, const SpanRows& other, double maxWidth,
                             const LayerFrame& frame);

} // namespace tetvdb
