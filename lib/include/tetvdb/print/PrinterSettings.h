// SPDX-License-Identifier: Apache-2.0
//
// The settings of a printer: its display, layer heights, exposure and lifts.
//
//   tetvdb::PrinterSettings printer = tetvdb::readPrinter("sl1s.ini");
#pragma once

#include <array>
#include <map>
#include <string>

namespace tetvdb {

/// Lengths in millimetres, times in seconds, speeds in millimetres per minute. Names in parentheses
/// are the keys of readPrinter(); those without an asterisk are PrusaSlicer's.
struct PrinterSettings {
  std::array<int, 2> pixels{0, 0};          ///< (display_pixels_x, display_pixels_y)
  std::array<double, 2> display{0, 0};      ///< (display_width, display_height)
  bool portrait = false;                    ///< the image is rotated (display_orientation)
  std::array<bool, 2> mirror{false, false}; ///< of the image (display_mirror_x, display_mirror_y)
  double maxHeight = 0;                     ///< of the print; 0: no limit (max_print_height)
  double layerHeight = 0;                   ///< (layer_height)
  double firstLayerHeight = 0;              ///< 0: same as the others (initial_layer_height)
  double exposure = 0;                      ///< (exposure_time)
  double firstExposure = 0;                 ///< (initial_exposure_time)
  int fadedLayers = 0;  ///< layers from the first layer's exposure to the others' (faded_layers)
  int bottomLayers = 1; ///< with the first layer's exposure and bottom lifts (bottom_layers*)
  double gamma = 1;     ///< (gamma_correction)
  /// Stretch factors of the model (relative_correction_x times material_correction_x and so
  /// on).
  std::array<double, 3> stretch{1, 1, 1};
  double xyOffset = 0;   ///< of every layer's outline, outward (absolute_correction)
  double footOffset = 0; ///< of the first layer's, inward, fading (elefant_foot_compensation)
  double liftHeight = 5, liftSpeed = 60, retractSpeed = 150; ///< (lift_height*, ...)
  double bottomLiftHeight = 5, bottomLiftSpeed = 60;         ///< (bottom_lift_height*, ...)
  double lightOffDelay = 0;                                  ///< (light_off_delay*)
  std::map<std::string, std::string> keys;                   ///< all keys of the file, unparsed

  double firstHeight() const { return firstLayerHeight > 0 ? firstLayerHeight : layerHeight; }
  /// Exposure of layer k: that of the first layer for bottom layers, then a linear transition.
  double exposureOf(int k) const;
};

/// Reads lines "key = value", with comments after # or ;. Keys that are not named above are kept
/// and have no effect. Throws Error(Invalid) for a file that cannot be read, has sections (a bundle
/// of several printers), or has an invalid value; the message names the line.
PrinterSettings readPrinter(const std::string& path);

/// Throws Error(Usage) if pixels, display or layer height are missing or invalid.
void checkPrinter(const PrinterSettings& printer);

} // namespace tetvdb
