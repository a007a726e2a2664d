// SPDX-License-Identifier: Apache-2.0
//
// Which part of a job this process does.
#pragma once

#include <string>

namespace tetvdb {

struct Shard {
  unsigned index = 0, count = 1; ///< index < count

  bool isWhole() const { return count == 1; }
  /// "3-of-16".
  std::string name() const;
};

/// "I/N" with I from 0 to N - 1; "auto": the task of a Slurm array (SLURM_ARRAY_TASK_ID, _MIN,
/// _STEP and _COUNT), else the rank that mpirun (OMPI_COMM_WORLD_RANK and _SIZE), another MPI
/// launcher (PMI_RANK and PMI_SIZE) or srun (SLURM_PROCID and SLURM_NTASKS) sets. Throws
/// Error(Usage) for what is neither, and for "auto" where nothing is set.
Shard parseShard(const std::string& text);

} // namespace tetvdb
