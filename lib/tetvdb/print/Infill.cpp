// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/print/Infill.h"

#include "tetvdb/geometry/VectorMath.h"
#include "tetvdb/surface/SampleBox.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <utility>

namespace tetvdb {
namespace {

constexpr double kTurn = 6.283185307179586;
constexpr std::size_t kCellSamples = std::size_t(1) << 18; // of a cell

constexpr std::array<std::pair<InfillKind, const char*>, 5> kNames = {{
    {InfillKind::Gyroid, "gyroid"},
    {InfillKind::SchwarzP, "schwarz-p"},
    {InfillKind::Diamond, "diamond"},
    {InfillKind::Bcc, "bcc"},
    {InfillKind::Octet, "octet"},
}};

struct Level {
  double value;
  Vec3d gradient; // by angles
};

// The surfaces' first Fourier terms (von Schnering and Nesper 1991).
Level levelOf(InfillKind kind, const Vec3d& s, const Vec3d& c) {
  switch (kind) {
  case InfillKind::Gyroid:
    return {s[0] * c[1] + s[1] * c[2] + s[2] * c[0],
            {c[0] * c[1] - s[2] * s[0], c[1] * c[2] - s[0] * s[1], c[2] * c[0] - s[1] * s[2]}};
  case InfillKind::SchwarzP:
    return {c[0] + c[1] + c[2], {-s[0], -s[1], -s[2]}};
  default:
    return {s[0] * s[1] * s[2] + s[0] * c[1] * c[2] + c[0] * s[1] * c[2] + c[0] * c[1] * s[2],
            {c[0] * s[1] * s[2] + c[0] * c[1] * c[2] - s[0] * s[1] * c[2] - s[0] * c[1] * s[2],
             s[0] * c[1] * s[2] - s[0] * s[1] * c[2] + c[0] * c[1] * c[2] - c[0] * s[1] * s[2],
             s[0] * s[1] * c[2] - s[0] * c[1] * s[2] - c[0] * s[1] * s[2] + c[0] * c[1] * c[2]}};
  }
}

double toSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d edge = minus(b, a);
  const double t = std::clamp(dot(minus(p, a), edge) / dot(edge, edge), 0.0, 1.0);
  return length(minus(p, plus(a, times(edge, t))));
}

// In an eighth of a cell of side 2: the others are its mirror images, and their struts are not
// closer. `p` is relative to a corner of the cell.
double toStrut(InfillKind kind, const Vec3d& p) {
  if (kind == InfillKind::Bcc)
    return toSegment(p, {0, 0, 0}, {1, 1, 1});
  constexpr Vec3d kNodes[4] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}};
  double nearest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < i; ++j)
      nearest = std::min(nearest, toSegment(p, kNodes[j], kNodes[i]));
  return nearest;
}

} // namespace

const char* nameOf(InfillKind kind) {
  return kNames[static_cast<std::size_t>(kind)].second;
}

bool readInfill(const std::string& name, InfillKind& kind) {
  for (const auto& [known, text] : kNames)
    if (name == text) {
      kind = known;
      return true;
    }
  return false;
}

Infill::Infill(InfillKind kind, double cell) : kind_(kind), cell_(cell), distances_(kCellSamples) {
  // Not on a lattice, which would have many equal distances.
  const Box box{{0, 0, 0}, {cell, cell, cell}};
  tbb::parallel_for(std::size_t(0), kCellSamples,
                    [&](std::size_t i) { distances_[i] = distanceAt(pointInBox(box, i)); });
  tbb::parallel_sort(distances_.begin(), distances_.end());
}

// The terms of a point's coordinate along one axis.
struct Infill::Term {
  double sine = 0, cosine = 0; // sheets
  double eighth = 0;           // struts: 0 to 1 from a corner of the cell to its midpoint
};

Infill::Term Infill::termAt(double x) const {
  Term term;
  if (kind_ == InfillKind::Bcc || kind_ == InfillKind::Octet) {
    const double at = x / cell_ - std::floor(x / cell_);
    term.eighth = 2 * std::min(at, 1 - at);
  } else {
    term.sine = std::sin(x * kTurn / cell_);
    term.cosine = std::cos(x * kTurn / cell_);
  }
  return term;
}

double Infill::distanceOf(const Term& x, const Term& y, const Term& z) const {
  if (kind_ == InfillKind::Bcc || kind_ == InfillKind::Octet)
    return toStrut(kind_, {x.eighth, y.eighth, z.eighth}) * cell_ / 2;
  const Level level = levelOf(kind_, {x.sine, y.sine, z.sine}, {x.cosine, y.cosine, z.cosine});
  const double slope = length(level.gradient) * kTurn / cell_;
  return slope > 0 ? std::abs(level.value) / slope : std::numeric_limits<double>::max();
}

double Infill::distanceAt(const Vec3d& p) const {
  return distanceOf(termAt(p[0]), termAt(p[1]), termAt(p[2]));
}

void Infill::distances(const Vec3d& first, double step, int count, double* out) const {
  std::array<std::vector<Term>, 3> terms;
  for (std::size_t k = 0; k < 3; ++k)
    for (int i = 0; i < count; ++i)
      terms[k].push_back(termAt(first[k] + step * i));
  for (const Term& x : terms[0])
    for (const Term& y : terms[1])
      for (const Term& z : terms[2])
        *out++ = distanceOf(x, y, z);
}

double Infill::thicknessFor(double density) const {
  const double at = std::clamp(density, 0.0, 1.0) * static_cast<double>(distances_.size()) - 0.5;
  const double last = static_cast<double>(distances_.size() - 1);
  const double inside = std::clamp(at, 0.0, last);
  const auto low = static_cast<std::size_t>(inside);
  const std::size_t high = std::min(low + 1, distances_.size() - 1);
  const double share = inside - static_cast<double>(low);
  return 2 * (distances_[low] + share * (distances_[high] - distances_[low]));
}

double Infill::densityOf(double thickness) const {
  const auto below = std::lower_bound(distances_.begin(), distances_.end(), thickness / 2);
  return static_cast<double>(below - distances_.begin()) / static_cast<double>(distances_.size());
}

} // namespace tetvdb
