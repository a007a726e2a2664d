// SPDX-License-Identifier: Apache-2.0
//
// All of the public interface, but for what shows OpenVDB's types: the grids of a volume are in
// tetvdb/volume/Grids.h.
//
//   tetvdb::VoxelizeJob job;
//   job.inputs = {"bracket.vtu"};
//   job.output = "bracket.vdb";
//   tetvdb::Report report;
//   tetvdb::Progress progress;
//   tetvdb::run(job, report, progress);
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Progress.h"
#include "tetvdb/core/Report.h"
#include "tetvdb/core/Version.h"
#include "tetvdb/io/ArrayFile.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MergeVdb.h"
#include "tetvdb/io/MeshReader.h"
#include "tetvdb/io/MeshWriter.h"
#include "tetvdb/io/TileFiles.h"
#include "tetvdb/io/TriangleReader.h"
#include "tetvdb/io/TriangleWriter.h"
#include "tetvdb/io/VolumeFile.h"
#include "tetvdb/io/VolumeStream.h"
#include "tetvdb/mesh/CellMesh.h"
#include "tetvdb/mesh/SplitCells.h"
#include "tetvdb/mesh/TetMesh.h"
#include "tetvdb/mesh/TriangleMesh.h"
#include "tetvdb/pipeline/CheckPrintJob.h"
#include "tetvdb/pipeline/CheckVolumes.h"
#include "tetvdb/pipeline/ConvertJob.h"
#include "tetvdb/pipeline/MemoryInput.h"
#include "tetvdb/pipeline/MeshSummary.h"
#include "tetvdb/pipeline/PrepareJob.h"
#include "tetvdb/pipeline/PrepareMesh.h"
#include "tetvdb/pipeline/RenderJob.h"
#include "tetvdb/pipeline/RepairJob.h"
#include "tetvdb/pipeline/SequenceJob.h"
#include "tetvdb/pipeline/Shard.h"
#include "tetvdb/pipeline/SliceJob.h"
#include "tetvdb/pipeline/SolidQuery.h"
#include "tetvdb/pipeline/TetrahedralizeJob.h"
#include "tetvdb/pipeline/VoxelizeJob.h"
#include "tetvdb/surface/CleanTriangles.h"
#include "tetvdb/surface/CompareMeshes.h"
#include "tetvdb/surface/SurfaceDefects.h"
#include "tetvdb/tetrahedralize/Tetrahedralize.h"
#include "tetvdb/volume/GridKinds.h"
#include "tetvdb/volume/LevelsOfDetail.h"
#include "tetvdb/volume/Volume.h"
#include "tetvdb/voxelize/ChooseTransform.h"
#include "tetvdb/voxelize/Voxelize.h"
#include "tetvdb/voxelize/VoxelizeTriangles.h"
