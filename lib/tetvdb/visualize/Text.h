// SPDX-License-Identifier: Apache-2.0
//
// Text in pictures: ASCII in a small bitmap font drawn for this project.
#pragma once

#include "tetvdb/visualize/Image.h"

#include <string>
#include <string_view>

namespace tetvdb {

/// How many pixels a dot of the font takes: 1 for pictures up to 720 pixels high, then more.
int textScale(int pictureHeight);

/// Width of a line of text in pixels, without the gap after its last letter.
int textWidth(std::string_view text, int scale);
/// From the top of capitals to the foot of letters that reach below the line.
int textHeight(int scale);
/// Of capitals and digits.
int capitalHeight(int scale);

/// Draws a line with the upper left corner of its first letter at (x, y). Bytes that are not
/// printable ASCII become '?', all bytes of one UTF-8 character together.
void drawText(Image& image, int x, int y, std::string_view text, const Pixel& color, int scale);

/// `text` with its central letters left out ("long..name.stl") where it is wider than so many
/// pixels.
std::string shortened(std::string_view text, int width, int scale);

} // namespace tetvdb
