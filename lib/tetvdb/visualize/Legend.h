// SPDX-License-Identifier: Apache-2.0
//
// The legend of a picture's colours.
#pragma once

#include "tetvdb/visualize/ColorMap.h"
#include "tetvdb/visualize/Image.h"

#include <vector>

namespace tetvdb {

/// Places of a legend's elements, in pixels of the picture.
struct LegendPlaces {
  int barLeft = 0, barRight = 0; ///< columns [barLeft, barRight) are coloured
  int barTop = 0, barBottom = 0; ///< rows [barTop, barBottom): high at the top
  std::vector<double> ticks;
  std::vector<int> tickRows; ///< where the line of each tick is drawn
};

/// Draws a bar with numbers, or a list of kinds, at the right edge of a picture, with the title
/// above. The row of a tick shows the colour of its number. Kinds without room are left out,
/// and a line gives their number.
LegendPlaces drawLegend(Image& image, const ColorScale& scale, const Pixel& ink);

/// Columns that drawLegend() takes from the right edge of a picture of that height.
int legendWidth(const ColorScale& scale, int pictureHeight);

/// Black or white, whichever has more contrast with a background.
Pixel inkOn(const Pixel& background);

} // namespace tetvdb
