// SPDX-License-Identifier: Apache-2.0
//
// Periodic lattices that fill a cavity: sheets along minimal surfaces, and struts.
//
//   const tetvdb::Infill infill(tetvdb::InfillKind::Gyroid, 5);
//   const bool isSolid = infill.distanceAt(p) < infill.thicknessFor(0.2) / 2;
#pragma once

#include "tetvdb/core/Vec3.h"
#include "tetvdb/print/InfillKind.h"

#include <vector>

namespace tetvdb {

/// A point is in the lattice if its distance to the sheet or to the nearest strut's axis is below
/// half of the thickness. Distances to struts are exact, those to sheets |f| / |grad f|: correct to
/// first order close to the sheet.
class Infill {
public:
  /// `cell` > 0, world units. Samples a cell at 2^18 points.
  Infill(InfillKind kind, double cell);

  /// Distance to the sheet or the nearest axis, world units. Thread-safe.
  double distanceAt(const Vec3d& p) const;

  /// The same for count^3 points from `first`, at intervals of `step`, [(x * count + y) * count +
  /// z]; 10 to 30 ns each.
  void distances(const Vec3d& first, double step, int count, double* out) const;

  /// The thickness for which this share of a cell, 0 to 1, is filled, by the samples.
  double thicknessFor(double density) const;
  /// The filled share of a cell.
  double densityOf(double thickness) const;

private:
  struct Term;
  Term termAt(double x) const;
  double distanceOf(const Term& x, const Term& y, const Term& z) const;

  InfillKind kind_;
  double cell_;
  std::vector<double> distances_; ///< of the samples, ascending
};

} // namespace tetvdb
