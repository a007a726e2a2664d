// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/tetrahedralize/complex/TetComplex.h"

#include <algorithm>
#include <cassert>
#include <stdexcept>
#include <string>

namespace tetvdb {
namespace {

using Key = std::array<std::uint32_t, 3>;

Key sorted(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  if (a > b)
    std::swap(a, b);
  if (b > c)
    std::swap(b, c);
  if (a > b)
    std::swap(a, b);
  return {a, b, c};
}

Key faceKey(const std::array<std::uint32_t, 4>& corners, unsigned localFace) {
  const auto& face = kFaceCorners[localFace];
  return sorted(corners[face[0]], corners[face[1]], corners[face[2]]);
}

} // namespace

std::uint32_t TetComplex::nextMark() const {
  if (++mark_ == 0) {
    for (Tet& tet : const_cast<std::vector<Tet>&>(tets)) // the marks alone
      tet.mark = 0;
    mark_ = 1;
  }
  return mark_;
}

std::uint32_t TetComplex::addPoint(const Vec3d& at) {
  Point point;
  point.at = at;
  points.push_back(point);
  return static_cast<std::uint32_t>(points.size() - 1);
}

unsigned TetComplex::localFaceOf(std::uint32_t t, std::uint32_t other) const {
  const auto& neighbours = tets[t].neighbours;
  unsigned localFace = 0;
  while (neighbours[localFace] != other) {
    ++localFace;
    assert(localFace < 4);
  }
  return localFace;
}

void TetComplex::star(std::uint32_t point, std::vector<std::uint32_t>& out,
                      std::size_t enough) const {
  out.clear();
  const std::uint32_t mark = nextMark();
  auto& all = const_cast<std::vector<Tet>&>(tets); // the marks alone
  const std::uint32_t first = points[point].tet;
  all[first].mark = mark;
  out.push_back(first);
  for (std::size_t i = 0; i < out.size() && out.size() <= enough; ++i) {
    const Tet& tet = tets[out[i]];
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (tet.corners[localFace] == point || next >= kElsewhere || all[next].mark == mark)
        continue;
      all[next].mark = mark;
      out.push_back(next);
    }
  }
}

bool TetComplex::hasMoreTets(std::uint32_t point, std::size_t count) const {
  star(point, stack_, count);
  return stack_.size() > count;
}

std::uint32_t TetComplex::tetAtEdge(std::uint32_t a, std::uint32_t b) const {
  star(a, stack_);
  for (const std::uint32_t t : stack_)
    if (tets[t].cornerOf(b) < 4)
      return t;
  return kNone;
}

bool TetComplex::ring(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& tetsAround,
                      std::vector<std::uint32_t>& ringPoints, std::uint32_t first) const {
  tetsAround.clear();
  ringPoints.clear();
  if (first == kNone)
    first = tetAtEdge(a, b);
  if (first == kNone)
    return false;
  std::uint32_t t = first;
  for (;;) {
    const Tet& tet = tets[t];
    const auto [k, l] = kEdgeOthers[tet.cornerOf(a)][tet.cornerOf(b)];
    tetsAround.push_back(t);
    ringPoints.push_back(tet.corners[k]);
    const std::uint32_t next = tet.neighbours[k];
    if (next == first)
      return true;
    if (next >= kElsewhere) {
      ringPoints.push_back(tet.corners[l]);
      return false;
    }
    t = next;
  }
}

TetComplex::OpenFace& TetComplex::findFace(const Key& key) {
  const std::size_t size = faces_.size() - 1;
  std::size_t i = (key[0] * std::size_t(0x9E3779B1u) ^ key[1] * std::size_t(0x85EBCA6Bu) ^
                   key[2] * std::size_t(0xC2B2AE35u));
  i = (i ^ (i >> 17)) & size;
  while (faces_[i].round == faceRound_ && faces_[i].key != key)
    i = (i + 1) & size;
  return faces_[i];
}

void TetComplex::replace(const std::vector<std::uint32_t>& old, const std::vector<NewTet>& fresh) {
  std::size_t room = 256;
  while (room < 8 * (old.size() + fresh.size()))
    room *= 2;
  if (faces_.size() < room) {
    faces_.assign(room, OpenFace{});
    faceRound_ = 0;
  }
  ++faceRound_;
  openFaces(old);
  for (const std::uint32_t t : old) {
    for (const std::uint32_t corner : tets[t].corners)
      points[corner].tet = kNone;
    tets[t].corners[0] = kNone;
    free_.push_back(t);
  }
  std::reverse(free_.end() - static_cast<std::ptrdiff_t>(old.size()), free_.end());
  for (const NewTet& one : fresh) {
    const std::uint32_t t = addTet(one);
    for (unsigned localFace = 0; localFace < 4; ++localFace)
      joinFace(t, localFace);
  }
}

// To faces_: the outer faces of these tets.
void TetComplex::openFaces(const std::vector<std::uint32_t>& old) {
  const std::uint32_t mark = nextMark();
  for (const std::uint32_t t : old)
    tets[t].mark = mark;
  for (const std::uint32_t t : old) {
    const Tet& tet = tets[t];
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (next < kElsewhere && tets[next].mark == mark)
        continue;
      const Key key = faceKey(tet.corners, localFace);
      findFace(key) = {key,
                       next,
                       next < kElsewhere ? localFaceOf(next, t) : 0,
                       tet.chains[localFace],
                       tet.tracked[localFace],
                       true,
                       faceRound_};
    }
  }
}

std::uint32_t TetComplex::addTet(const NewTet& one) {
  std::uint32_t t;
  if (free_.empty()) {
    t = static_cast<std::uint32_t>(tets.size());
    tets.emplace_back();
  } else {
    t = free_.back();
    free_.pop_back();
  }
  Tet& tet = tets[t];
  tet.corners = one.corners;
  tet.chains = one.chains;
  tet.tracked = one.tracked;
  tet.energy = 0;
  tet.mark = 0;
  tet.weight = one.weight;
  for (const std::uint32_t corner : one.corners) {
    points[corner].tet = t;
    points[corner].changed = 0xFF;
  }
  return t;
}

// Joins a face of a new tet to the tet in faces_ that has it too, or puts it there.
void TetComplex::joinFace(std::uint32_t t, unsigned localFace) {
  Tet& tet = tets[t];
  const Key key = faceKey(tet.corners, localFace);
  OpenFace& face = findFace(key);
  if (face.round != faceRound_) {
    face = {key, t, localFace, 0, false, false, faceRound_};
    tet.neighbours[localFace] = kOutside;
    return;
  }
  tet.neighbours[localFace] = face.tet;
  if (face.border) {
    tet.chains[localFace] += face.chain;
    tet.tracked[localFace] = tet.tracked[localFace] || face.tracked;
  } else {
    assert(tets[face.tet].chains[face.localFace] == -tet.chains[localFace]);
  }
  if (face.tet < kElsewhere) {
    Tet& other = tets[face.tet];
    other.neighbours[face.localFace] = t;
    other.chains[face.localFace] = -tet.chains[localFace];
    other.tracked[face.localFace] = tet.tracked[localFace];
  }
}

void TetComplex::collapse(std::uint32_t from, std::uint32_t to,
                          const std::vector<std::uint32_t>& star) {
  const auto join = [this](std::uint32_t t, std::uint32_t gone, std::uint32_t next, Chain chain,
                           bool isTracked) {
    const unsigned localFace = localFaceOf(t, gone);
    tets[t].neighbours[localFace] = next;
    tets[t].chains[localFace] = chain;
    tets[t].tracked[localFace] = isTracked;
  };
  for (const std::uint32_t t : star) {
    Tet& tet = tets[t];
    const unsigned i = tet.cornerOf(from), j = tet.cornerOf(to);
    if (j == 4) {
      tet.corners[i] = to;
      tet.energy = 0;
      for (const std::uint32_t corner : tet.corners)
        points[corner].changed = 0xFF;
      continue;
    }
    const std::uint32_t beyond = tet.neighbours[i], inside = tet.neighbours[j];
    const Chain chain = tet.chains[i] - tet.chains[j];
    const bool isTracked = tet.tracked[i] || tet.tracked[j];
    join(inside, t, beyond, chain, isTracked);
    if (beyond < kElsewhere)
      join(beyond, t, inside, -chain, isTracked);
    for (const std::uint32_t corner : tet.corners)
      points[corner].tet = inside;
    tet.corners[0] = kNone;
    free_.push_back(t);
  }
  points[from].tet = kNone;
}

void TetComplex::move(std::uint32_t point, const Vec3d& to,
                      const std::vector<std::uint32_t>& star) {
  points[point].at = to;
  for (const std::uint32_t t : star) {
    tets[t].energy = 0;
    for (const std::uint32_t corner : tets[t].corners)
      points[corner].changed = 0xFF;
  }
}

void TetComplex::crossOver(std::uint32_t t, float weight) {
  Tet& tet = tets[t];
  Chain out = 0;
  for (unsigned localFace = 0; localFace < 4; ++localFace)
    if (tet.tracked[localFace])
      out = tet.chains[localFace];
  for (unsigned localFace = 0; localFace < 4; ++localFace) {
    const std::uint32_t next = tet.neighbours[localFace];
    tet.chains[localFace] -= out;
    tet.tracked[localFace] = !tet.tracked[localFace];
    assert(next < kElsewhere && (tet.tracked[localFace] || tet.chains[localFace] == 0));
    const unsigned back = localFaceOf(next, t);
    tets[next].chains[back] = -tet.chains[localFace];
    tets[next].tracked[back] = tet.tracked[localFace];
    points[tet.corners[localFace]].changed = 0xFF;
  }
  tet.weight = weight;
  tet.energy = 0;
}

void TetComplex::verify() const {
  const auto fail = [](const char* what, std::size_t where) {
    throw std::logic_error(std::string(what) + " at " + std::to_string(where));
  };
  for (std::size_t t = 0; t < tets.size(); ++t) {
    const Tet& tet = tets[t];
    if (!tet.exists())
      continue;
    for (const std::uint32_t corner : tet.corners)
      if (corner >= points.size() || !points[corner].exists())
        fail("a tet has a point that is gone", t);
    if (!isPositive(tet.corners))
      fail("a tet is not positive", t);
    for (unsigned localFace = 0; localFace < 4; ++localFace) {
      const std::uint32_t next = tet.neighbours[localFace];
      if (next >= kElsewhere)
        continue;
      const Tet& other = tets[next];
      if (!other.exists())
        fail("a neighbour is gone", t);
      const auto back = std::find(other.neighbours.begin(), other.neighbours.end(),
                                  static_cast<std::uint32_t>(t));
      if (back == other.neighbours.end())
        fail("neighbours do not agree", t);
      const auto otherFace = static_cast<unsigned>(back - other.neighbours.begin());
      if (faceKey(tet.corners, localFace) != faceKey(other.corners, otherFace))
        fail("neighbours do not share the face's points", t);
      if (tet.chains[localFace] != -other.chains[otherFace] ||
          tet.tracked[localFace] != other.tracked[otherFace])
        fail("neighbours do not agree on what a face represents", t);
      if (tet.chains[localFace] != 0 && !tet.tracked[localFace])
        fail("a face has a chain but is not tracked", t);
    }
  }
  for (std::size_t p = 0; p < points.size(); ++p)
    if (points[p].exists() && (points[p].tet >= tets.size() ||
                               tets[points[p].tet].cornerOf(static_cast<std::uint32_t>(p)) == 4))
      fail("a point does not know its tet", p);
}

} // namespace tetvdb
