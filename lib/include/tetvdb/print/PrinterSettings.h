// SPDX-License-Identifier: Apache-2.0
//
// What a printer of layers is told: its display, heights of layers, exposure and lifts.
//
//   tetvdb::PrinterSettings printer = tetvdb::readPrinter("sl1s.ini");
#pragma once

#include <array>
#include <map>
#include <string>

namespace tetvdb {

/// Lengths in millimetres, times in seconds, speeds in millimetres a minute. Names in brackets are
/// the keys of readPrinter(); those without a star are PrusaSlicer's.
struct PrinterSettings {
  std::array<int, 2> pixels{0, 0};     ///< (display_pixels_x, display_pixels_y)
  std::array<double, 2> display{0, 0}; ///< (display_width, display_height)
  bool portrait = false;               ///< the image is the display turned (display_orientation)
  std::array<bool, 2> mirror{false, false}; ///< of the image (display_mirror_x, display_mirror_y)
  double maxHeight = 0;                     ///< of the print; 0: no limit (max_print_height)
  double layerHeight = 0;                   ///< (layer_height)
  double firstLayerHeight = 0;              ///< 0: as the others (initial_layer_height)
  double exposure = 0;                      ///< (exposure_time)
  double firstExposure = 0;                 ///< (initial_exposure_time)
  int fadedLayers = 0;  ///< from the first layer's exposure to the others' (faded_layers)
  int bottomLayers = 1; ///< with the first layer's exposure and bottom lifts (bottom_layers*)
  double gamma = 1;     ///< (gamma_correction)
  /// Factors that the model is stretched by (relative_correction_x times material_correction_x and
  /// so on).
  std::array<double, 3> stretch{1, 1, 1};
  double xyOffset = 0;   ///< of every layer's outline, outward (absolute_correction)
  double footOffset = 0; ///< of the first layer's, inward, fading (elefant_foot_compensation)
  double liftHeight = 5, liftSpeed = 60, retractSpeed = 150; ///< (lift_height*, ...)
  double bottomLiftHeight = 5, bottomLiftSpeed = 60;         ///< (bottom_lift_height*, ...)
  double lightOffDelay = 0;                                  ///< (light_off_delay*)
  std::map<std::string, std::string> keys;                   ///< all of the file, in its words

  double firstHeight() const { return firstLayerHeight > 0 ? firstLayerHeight : layerHeight; }
  /// Of layer k: the first layer's for the bottom ones, then evenly to that of the others.
  double exposureOf(int k) const;
};

/// Lines "key = value", with comments that begin with # or ;. Keys that are not named above are
/// kept and have no effect. Throws Error(Invalid) for a file that cannot be read, has sections (a
/// bundle of several printers), or has a value that is none; the line is named.
PrinterSettings readPrinter(const std::string& path);

/// Throws Error(Usage) where pixels, display or layer height are missing or make no sense.
void checkPrinter(const PrinterSettings& printer);

} // namespace tetvdb
