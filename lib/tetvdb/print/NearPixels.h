// SPDX-License-Identifier: Apache-2.0
//
// Sets of pixels by their distance to others, and the thin parts of a set.
//
//   tetvdb::SpanRows thin = tetvdb::thinPixels(solid, 0.4, frame);
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/LayerComponents.h"
#include "tetvdb/print/SpanRows.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// The pixels whose centres are within `radius` millimetres (or, if it is open, closer than that)
/// of the centre of one pixel, which may be non-square: by row, their extent.
class PixelDisc {
public:
  PixelDisc(double pixelWidth, double pixelHeight, double radius, bool open);

  /// Rows on either side of the middle one; -1 where the disc is empty.
  std::int32_t rows() const { return static_cast<std::int32_t>(reach_.size()) - 1; }
  /// Columns on either side, for the row `dy` rows away.
  std::int32_t reach(std::int32_t dy) const {
    return reach_[static_cast<std::size_t>(dy < 0 ? -dy : dy)];
  }

private:
  std::vector<std::int32_t> reach_;
};

/// The pixels of `from` whose disc contains no pixel of `other`. About 5 ns per row of the disc and
/// remaining span of a row.
SpanRows withoutNear(const SpanRows& from, const SpanRows& other, const PixelDisc& disc);

/// The complement of `set`, in the rows from `margin` above its first to `margin` below its last;
/// spans extend from -kFar to kFar.
SpanRows complementOf(const SpanRows& set, std::int32_t margin);
constexpr std::int32_t kFar = 1 << 28;

/// The parts of a set that are thinner than `limit` millimetres. A core pixel is one of the set
/// with no pixel outside of it closer than limit / 2; thin are the pixels of the set that are
/// farther than `limit` from every core pixel. Corners of 60 degrees and more are therefore not
/// thin, nor are the ends of parts as wide as `limit`; parts up to one pixel narrower may pass.
/// Distances are between centres of pixels.
SpanRows thinPixels(const SpanRows& set, double limit, const LayerFrame& frame);

/// The same for the complement of the set.
SpanRows thinGaps(const SpanRows& set, double limit, const LayerFrame& frame);

/// For each label of `part`: the width of the surrounding set there, millimetres, up to `maxWidth`:
/// twice the distance from the middle of one of its spans to the nearest pixel of `other`, the
/// complement of that set, minus a pixel, so that a row of single pixels is one pixel wide. Too
/// small by less than a pixel.
std::vector<double> widthsOf(const LabelledSpans& part, const SpanRows& other, double maxWidth,
                             const LayerFrame& frame);

} // namespace tetvdb
