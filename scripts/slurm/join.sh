#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# The end of a data set, with the same options: sbatch --dependency=afterok:JOBID join.sh LIST FOLDER [options]
#SBATCH --job-name=tetvdb-join
#SBATCH --nodes=1
set -eu
list=$1 folder=$2
shift 2
exec "${TETVDB:-tetvdb}" dataset "$list" -o "$folder" --join "$@"
