#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# One part of a volume: sbatch --array=0-15 shards.sh MESH OUT.vdb [options of tetvdb voxelize]
#SBATCH --job-name=tetvdb-shards
#SBATCH --nodes=1
#SBATCH --requeue
set -eu
mesh=$1 out=$2
shift 2
exec "${TETVDB:-tetvdb}" voxelize "$mesh" -o "$out" --shard auto --threads "${SLURM_CPUS_ON_NODE:-1}" "$@"
