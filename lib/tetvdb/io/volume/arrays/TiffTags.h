// SPDX-License-Identifier: Apache-2.0
//
// Tags of TIFF's directories, and types of their values: "TIFF Revision 6.0", sections 2 to 15, and
// "BigTIFF". Internal.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tetvdb::tiff {

enum Tag : std::uint16_t {
  kSubfileType = 254,
  kImageWidth = 256,
  kImageLength = 257,
  kBitsPerSample = 258,
  kCompression = 259,
  kPhotometric = 262,
  kImageDescription = 270,
  kStripOffsets = 273,
  kSamplesPerPixel = 277,
  kRowsPerStrip = 278,
  kStripByteCounts = 279,
  kXResolution = 282,
  kYResolution = 283,
  kPlanarConfiguration = 284,
  kResolutionUnit = 296,
  kSoftware = 305,
  kPredictor = 317,
  kTileWidth = 322,
  kTileLength = 323,
  kTileOffsets = 324,
  kTileByteCounts = 325,
  kSampleFormat = 339
};
enum Type : std::uint16_t {
  kByte = 1,
  kAscii = 2,
  kShort = 3,
  kLong = 4,
  kRational = 5,
  kLong8 = 16
};

/// Bytes of a value; 0 for other types.
constexpr std::size_t sizeOf(Type type) {
  switch (type) {
  case kByte:
  case kAscii:
    return 1;
  case kShort:
    return 2;
  case kLong:
    return 4;
  case kRational:
  case kLong8:
    return 8;
  }
  return 0;
}

} // namespace tetvdb::tiff
