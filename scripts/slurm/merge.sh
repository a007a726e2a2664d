#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Joins the parts of N tasks: sbatch --dependency=afterok:JOBID merge.sh OUT.vdb N
#SBATCH --job-name=tetvdb-merge
#SBATCH --nodes=1
set -eu
out=$1 count=$2
exec "${TETVDB:-tetvdb}" merge "${out%.vdb}".*-of-"$count".vdb -o "$out"
