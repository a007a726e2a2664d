// SPDX-License-Identifier: Apache-2.0
//
// Jobs that hand out what they make: run, the thing as a Python object, the report kept with it.
#pragma once

#include "JobReport.h"
#include "Report.h"
#include "RunJob.h"

#include <memory>
#include <string>
#include <utility>

namespace tetvdb::python {

/// Runs `job`, whose member `keep` is set, and returns `objectOf(what it kept, its report)`. The
/// caller's arrays in job.memory are let go of then.
template <typename Job, typename ObjectOf>
nb::object keptResult(const char* command, Job job, const JobLimits& limits,
                      const ObjectOf& objectOf) {
  JobRun work(limits);
  auto made = work([&](Report& report, Progress& progress) { return run(job, report, progress); });
  auto kept = std::move(*made.kept);
  made.kept.reset();
  job.memory.clear();
  struct Done {
    Job job;
    decltype(made) result;
    Report report;
  };
  const auto done =
      std::make_shared<const Done>(Done{std::move(job), std::move(made), std::move(work.report())});
  return objectOf(std::move(kept), [done, name = std::string(command)] {
    return cli::reportText(name, statusOf(done->report), "", done->report,
                           cli::sectionsOf(done->job, done->result));
  });
}

} // namespace tetvdb::python
