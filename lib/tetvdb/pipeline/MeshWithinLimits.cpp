// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/MeshWithinLimits.h"

#include <new>

namespace tetvdb {
namespace {

// Sets the deadline to half of the remaining time during its lifetime.
class HalfOfTheTime {
public:
  explicit HalfOfTheTime(Progress& progress) : progress_(progress), deadline_(progress.deadline()) {
    if (deadline_ == Progress::Clock::time_point::max())
      return;
    const auto now = Progress::Clock::now();
    progress_.setDeadline(now + (deadline_ - now) / 2);
  }
  ~HalfOfTheTime() { progress_.setDeadline(deadline_); }
  HalfOfTheTime(const HalfOfTheTime&) = delete;
  HalfOfTheTime& operator=(const HalfOfTheTime&) = delete;

private:
  Progress& progress_;
  Progress::Clock::time_point deadline_;
};

// The reason why the mesher stopped, if another method may be used.
std::string reasonOf(const Error& error) {
  switch (error.status()) {
  case Status::Cancelled:
    return "half of the time allowed did not suffice";
  case Status::Limit:
    return "it needs too many tets";
  case Status::Invalid:
    return "it found nothing inside";
  default:
    return "";
  }
}

} // namespace

std::optional<Tetrahedralization> meshWithinLimits(const std::vector<TriangleMesh>& inputs,
                                                   const TetrahedralizeOptions& options,
                                                   MesherStop& stop, Report& report,
                                                   Progress& progress) {
  progress.check();
  const std::size_t warnings = report.warnings.size();
  const bool partial = report.partial;
  try {
    TetrahedralizeOptions limited = options;
    limited.limitsWork = progress.deadline() == Progress::Clock::time_point::max();
    const HalfOfTheTime half(progress);
    return tetrahedralize(inputs, limited, report, progress);
  } catch (const Error& error) {
    stop = {error.status(), reasonOf(error)};
    if (stop.why.empty() || progress.cancelled())
      throw;
  } catch (const std::bad_alloc&) {
    stop = {Status::Limit, "memory ran out"};
  }
  report.warnings.resize(warnings);
  report.partial = partial;
  progress.check();
  return std::nullopt;
}

} // namespace tetvdb
