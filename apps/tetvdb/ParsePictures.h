// SPDX-License-Identifier: Apache-2.0
//
// Parses option values of pictures. Every function throws Error(Usage) that names the option.
#pragma once

#include "tetvdb/visualize/PictureMaker.h"

#include <array>
#include <string>

namespace tetvdb::cli {

/// "x=0.5": a share of the box, 0 to 1; "y=-12.5u": a coordinate.
Cut parseCut(const std::string& option, const std::string& text);

/// "-1:2.5", ascending.
std::array<double, 2> parseRange(const std::string& option, const std::string& text);

/// "640x480", each from 1 to 65535.
void parseSize(const std::string& option, const std::string& text, int& width, int& height);

/// "sky", "white", "black", "transparent", "#RRGGBB" or two of these with a comma.
void parseBackground(const std::string& option, const std::string& text, Pixel& top, Pixel& bottom);

} // namespace tetvdb::cli
