// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/io/cells/FaceCollector.h"

#include "tetvdb/core/Error.h"

namespace tetvdb {

void FaceCollector::failTooManyPoints() const {
  throw Error(Status::Limit, path_, "more than 4294967294 points", "split it into several files");
}

void FaceCollector::removeBadSuspects() {
  std::vector<std::uint32_t>& triangles = mesh_.triangles;
  std::size_t kept = 0, taken = 0; // numbers below these are in place, or processed
  const auto keepUntil = [&](std::size_t end) {
    if (kept != taken)
      std::copy(triangles.begin() + static_cast<std::ptrdiff_t>(taken),
                triangles.begin() + static_cast<std::ptrdiff_t>(end),
                triangles.begin() + static_cast<std::ptrdiff_t>(kept));
    kept += end - taken;
    taken = end;
  };
  for (const Suspect& suspect : suspects_) {
    const std::size_t end = suspect.first + 3 * suspect.count;
    bool bad = false;
    for (std::size_t i = suspect.first; i < end && !bad; ++i)
      bad = isBad(triangles[i]);
    if (!bad)
      continue;
    noteBadFace(suspect.face);
    keepUntil(suspect.first);
    taken = end;
  }
  keepUntil(triangles.size());
  triangles.resize(kept);
}

TriangleMesh FaceCollector::finish(Report& report) {
  if (!suspects_.empty())
    removeBadSuspects();
  mesh_.faceCount = facesSeen_ - badFaces_;
  if (facesSeen_ == 0)
    throw Error(Status::Invalid, path_,
                mesh_.points.empty()
                    ? "it holds no faces"
                    : "it holds " + std::to_string(mesh_.points.size()) + " points but no faces",
                "points alone have no inside; export the mesh with its faces");
  if (mesh_.triangles.empty())
    throw Error(Status::Invalid, path_,
                "none of its " + std::to_string(facesSeen_) +
                    " faces can be used: they name vertices that do not exist or are not finite, "
                    "or have fewer than three",
                "the file is damaged; export it again");
  if (!badPoints_.empty())
    report.warn("bad-vertices", std::to_string(badPoints_.size()) +
                                    (badPoints_.size() == 1
                                         ? " vertex is not three finite numbers; it is number "
                                         : " vertices are not three finite numbers; the first is "
                                           "number ") +
                                    std::to_string(badPoints_[0] + 1));
  if (badFaces_ > 0)
    warnOfBadFaces(report, badFaces_,
                   "vertices that do not exist or are not finite, or fewer than three corners; the "
                   "first is number " +
                       std::to_string(firstBadFace_));
  return std::move(mesh_);
}

void warnOfBadFaces(Report& report, std::size_t count, const std::string& why) {
  report.warn("bad-faces", std::to_string(count) +
                               (count == 1 ? " face was left out: " : " faces were left out: ") +
                               why);
  report.partial = true;
}

} // namespace tetvdb
