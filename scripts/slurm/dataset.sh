#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# One task of a data set: sbatch --array=0-15 dataset.sh LIST FOLDER [options of tetvdb dataset]
#SBATCH --job-name=tetvdb-dataset
#SBATCH --nodes=1
#SBATCH --requeue
set -eu
list=$1 folder=$2
shift 2
# A task that is requeued goes on with the models that are not done.
exec "${TETVDB:-tetvdb}" dataset "$list" -o "$folder" --shard auto --resume \
  --workers "${SLURM_CPUS_ON_NODE:-1}" "$@"
