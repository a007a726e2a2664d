// SPDX-License-Identifier: Apache-2.0
//
// Finds void that a print encloses while it grows: cups and traps.
//
//   tetvdb::CavitySweep sweep(frame);
//   for (k = 0; ...)
//     sweep.add(layer.gaps, voidContacts(below, layer));
//   sweep.finish();
#pragma once

#include "tetvdb/print/Layer.h"
#include "tetvdb/print/LayerComponents.h"
#include "tetvdb/print/LayerContacts.h"

#include <cstdint>
#include <vector>

namespace tetvdb {

/// A component of the void of layers 0 to k, tracked while k grows, which is not connected to the
/// outside. The plate closes its bottom. Components that meet are merged.
struct LayerCavity {
  enum class End : std::uint8_t {
    Open,   ///< is connected to the outside in layer last + 1, or is open above the last layer
    Closed, ///< is enclosed by solid, and possibly the plate below
  };
  End end = End::Open;
  bool onPlate = false; ///< has void in layer 0
  std::int32_t first = 0, last = 0;
  double voxels = 0; ///< pixels of all its layers
  double volume = 0; ///< cubic millimetres
  /// The void of one layer that is largest, the first such, and its largest component.
  std::int64_t largestPixels = 0;
  std::int32_t largestLayer = 0;
  ComponentShape largest;
  PixelBox box;
};

/// Tracks components of the void upward (as IslandSweep does for the solid). The void around the
/// image and above the last layer is outside. Memory: the components of two layers, and the
/// cavities. Cost: about 50 ns per component and contact. Independent of the order of contacts.
class CavitySweep {
public:
  explicit CavitySweep(const LayerFrame& frame) : frame_(frame) {}

  /// Adds the next layer, from 0; `contacts` are those of voidContacts() with the previous layer.
  void add(const LabelledSpans& gaps, const std::vector<LayerContact>& contacts);
  /// To be called after the last layer.
  void finish();

  /// The components that reach the last added layer and are not connected to the outside; and for
  /// each label of a component of that layer its index here, or kOutside.
  static constexpr std::uint32_t kOutside = ~std::uint32_t(0);
  const std::vector<LayerCavity>& open() const { return open_; }
  const std::vector<std::uint32_t>& openOf() const { return openOf_; }
  /// Permanent numbers of open(); of two merged ones, one is kept.
  const std::vector<std::uint32_t>& numbers() const { return numbers_; }

  /// All cavities that have ended, in the order of their ends, then of their first spans in their
  /// last layers.
  const std::vector<LayerCavity>& cavities() const { return ended_; }
  /// The index in cavities() of the cavity with this number, after finish().
  std::uint32_t cavityOf(std::uint32_t number);

private:
  void end(std::uint32_t cavity, LayerCavity::End how);

  LayerFrame frame_;
  std::int32_t k_ = 0;
  std::vector<LayerCavity> open_, ended_;
  std::vector<std::uint32_t> openOf_, numbers_;
  std::vector<std::uint32_t> becomes_; ///< by number: itself, or the number of a later one
  std::vector<std::uint32_t> endedAs_; ///< by number
};

} // namespace tetvdb
