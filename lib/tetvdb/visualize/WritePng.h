// SPDX-License-Identifier: Apache-2.0
//
// Pictures as PNG files.
#pragma once

#include "tetvdb/visualize/Image.h"

#include <string>

namespace tetvdb {

/// The bytes of a PNG file: 8 bits a channel, marked as sRGB, with alpha only where a pixel is not
/// opaque. The same bytes for the same picture: no time, no name of a program. About 10 ms for
/// 640 x 480. Throws Error(Limit) for a picture without pixels or beyond what PNG holds.
std::string encodePng(const Image& image);

/// The same to a file, whole or absent. Throws Error(Write).
void writePng(const std::string& path, const Image& image);

} // namespace tetvdb
