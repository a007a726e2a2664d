# SPDX-License-Identifier: Apache-2.0
"""What `tetvdb convert` reads from files of arrays, judged by the formats' own libraries: NumPy,
pynrrd, nibabel, SimpleITK, tifffile and VTK write random arrays, of every type of numbers, and the
volume made of them, written as .npz, must hold the same numbers at the same places.

    judge_arrays.py [SEED (1) [COUNT (8)]]

Skipped (77) where NumPy is missing; libraries that are missing are named and left out.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
except ImportError as error:
    print("skipped: %s" % error)
    sys.exit(77)

PROGRAM = os.environ["TETVDB_PROGRAM"]
TYPES = ["i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8", "f2", "f4", "f8"]


def optional(name):
    try:
        return __import__(name)
    except ImportError:
        print("without %s" % name)
        return None


nrrd, nibabel, sitk, tifffile, codecs, vtk = map(
    optional, ["nrrd", "nibabel", "SimpleITK", "tifffile", "imagecodecs", "vtk"])


def random_array(random, types, components=None, least=1):
    least = 2 if components else least
    shape = tuple(int(n) for n in random.integers(least, 40, 3)) + ((components,) if components else ())
    kind = np.dtype(str(random.choice(types)))
    if kind.kind == "f":
        values = random.normal(0, 100, shape)
    else:
        info = np.iinfo(kind)
        top = min(info.max, 2**62) if random.random() < 0.3 else 100
        values = random.integers(max(info.min, -100), top, shape, endpoint=True)
    values = np.array(values).astype(kind)
    values[random.random(shape) < random.random()] = 0  # regions of background
    if random.random() < 0.5:
        cut = int(random.integers(0, shape[0] + 1))
        values[:cut] = 0
    return values


def volume_of(path, folder, *options):
    """The first grid of the volume as (array of the box from `low` on, transform), or None."""
    vdb, npz = folder / "read.vdb", folder / "read.npz"
    done = subprocess.run([PROGRAM, "convert", str(path), "-o", str(vdb), "-q", *options],
                          stderr=subprocess.PIPE, universal_newlines=True, timeout=120)
    if done.returncode != 0:
        return None, done.stderr
    subprocess.run([PROGRAM, "convert", str(vdb), "-o", str(npz), "-q", "--sparse"], check=True, timeout=120)
    with np.load(npz) as found:
        return {name: found[name] for name in found.files}, ""


def check(name, path, folder, values, transform, *options, low=(0, 0, 0), tolerance=0.0, digits=1e-6):
    """`values`: [x][y][z] or with components last; `transform`: 4 x 4 or None."""
    grid, error = volume_of(path, folder, *options)
    nonzero = np.argwhere(np.any(values != 0, axis=3) if values.ndim == 4 else values != 0)
    if grid is None:
        if len(nonzero) == 0:
            return True
        print("FAILED %s: %s" % (name, error.strip()))
        return False
    names = sorted(key[:-12] for key in grid if key.endswith(".coordinates"))
    ok = True
    if len(names) == 1:
        at, got = grid[names[0] + ".coordinates"] - np.array(low), grid[names[0] + ".values"]
        expected = values[tuple(nonzero.T)]
        order = np.lexsort(at.T[::-1])
        at, got = at[order], got[order]
        ok = at.shape == nonzero.shape and np.array_equal(at, nonzero)
        if ok and got.dtype.kind == "f":
            with np.errstate(over="ignore"):
                expected = expected.astype(np.float32)
            ok = np.allclose(got, expected, rtol=tolerance, atol=0) if tolerance else np.array_equal(got, expected)
        elif ok:
            ok = np.array_equal(got.astype(np.float64), expected.astype(np.float64))
    else:
        for k, one in enumerate(names):
            part = values[..., k]
            at = np.argwhere(part != 0)
            found = grid[one + ".coordinates"] - np.array(low)
            order = np.lexsort(found.T[::-1])
            expected = part[tuple(at.T)]
            if expected.dtype.kind == "f":
                expected = expected.astype(np.float32)
            got = grid[one + ".values"][order].astype(np.float64)
            ok = ok and np.array_equal(found[order], at) and np.allclose(got, expected, rtol=tolerance, atol=0)
    if ok and transform is not None and not np.allclose(grid["transform"], transform, rtol=digits, atol=digits):
        print("transform", grid["transform"], transform)
        ok = False
    if not ok:
        print("FAILED %s: %s %s" % (name, values.dtype, values.shape))
    return ok


def turned(random):
    """A random rotation with spacings and a translation."""
    q, _ = np.linalg.qr(random.normal(0, 1, (3, 3)))
    matrix = np.eye(4)
    matrix[:3, :3] = q * random.uniform(0.2, 3, 3)
    matrix[:3, 3] = random.uniform(-50, 50, 3)
    return matrix


def judge_numpy(random, folder):
    values = random_array(random, TYPES + [">i2", ">f4", ">f8", ">u4"], random.choice([None, None, 1, 2, 3, 4]))
    order = random.choice(["C", "F"])
    stored = np.array(values, order=order)
    np.save(folder / "a.npy", stored)
    flat = values[..., 0] if values.ndim == 4 and values.shape[3] == 1 else values
    ok = check("npy", folder / "a.npy", folder, flat, np.eye(4))
    if values.ndim == 3:
        np.save(folder / "b.npy", np.ascontiguousarray(values.transpose(2, 1, 0)))
        ok &= check("npy zyx", folder / "b.npy", folder, values, np.diag([2, 2, 2, 1]), "--axes", "zyx",
                    "--voxel-size", "2")
    save = np.savez_compressed if random.random() < 0.5 else np.savez
    save(folder / "a.npz", field=stored, labels=np.arange(3), name=np.array("text"))
    return ok & check("npz", folder / "a.npz", folder, flat, np.eye(4))


def judge_nrrd(random, folder):
    values = random_array(random, [t for t in TYPES if t != "f2"] + [">i2", ">f4"])
    matrix = turned(random)
    header = {"space": "left-posterior-superior", "space directions": matrix[:3, :3].T,
              "space origin": matrix[:3, 3], "kinds": ["domain"] * 3,
              "encoding": str(random.choice(["raw", "gzip", "ascii"]))}
    if values.dtype.kind == "f" and header["encoding"] == "ascii":
        header["encoding"] = "raw"
    detached = random.random() < 0.3
    path = folder / ("a.nhdr" if detached else "a.nrrd")
    nrrd.write(str(path), values, header)
    return check("nrrd %s" % header["encoding"], path, folder, values, matrix)


def judge_nifti(random, folder):
    values = random_array(random, ["i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8", "i8", "u8"])
    matrix = turned(random)
    kind = nibabel.Nifti1Image if random.random() < 0.5 else nibabel.Nifti2Image
    image = kind(values, matrix, dtype=values.dtype)
    if random.random() < 0.5:
        image.set_sform(None, 0)
        image.set_qform(matrix, 1)
    path = folder / str(random.choice(["a.nii", "a.nii.gz"]))
    nibabel.save(image, str(path))
    return check("nifti", path, folder, values, image.affine)


def judge_itk(random, folder):
    values = random_array(random, ["u1", "i2", "u2", "i4", "f4", "f8"], random.choice([None, 3]))
    matrix = turned(random)
    image = sitk.GetImageFromArray(np.ascontiguousarray(np.moveaxis(values, [0, 1, 2], [2, 1, 0])),
                                   isVector=values.ndim == 4)
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    image.SetSpacing(spacing.tolist())
    image.SetOrigin(matrix[:3, 3].tolist())
    image.SetDirection((matrix[:3, :3] / spacing).ravel().tolist())
    path = folder / str(random.choice(["b.nrrd", "b.mha", "b.mhd", "b.nii.gz"]))
    sitk.WriteImage(image, str(path), bool(random.random() < 0.5))
    flips = np.diag([-1, -1, 1, 1]) if path.suffix == ".gz" else np.eye(4)  # ITK's axes are LPS, NIfTI's RAS
    if path.suffix == ".gz" and values.ndim == 4:
        return True  # ITK turns the vectors as well
    return check("itk", path, folder, values, flips @ matrix, tolerance=1e-6)


def judge_tiff(random, folder):
    values = random_array(random, ["u1", "u2", "u4", "i1", "i2", "i4", "f2", "f4", "f8"], random.choice([None, None, 3]), 2)
    pages = np.ascontiguousarray(np.moveaxis(values, [0, 1, 2], [2, 1, 0]))
    compression = random.choice([None, "zlib"] + (["lzw", "packbits"] if codecs else []))
    options = {"compression": None if compression is None else str(compression),
               "photometric": "rgb" if values.ndim == 4 else "minisblack",
               "bigtiff": bool(random.random() < 0.3), "byteorder": str(random.choice(["<", ">"]))}
    if values.ndim == 4:
        options["planarconfig"] = "contig"
    if compression in ("zlib", "lzw") and random.random() < 0.5 and values.dtype.kind in "iu":
        options["predictor"] = True
    if random.random() < 0.3:
        options["tile"] = (16, 32)
    elif random.random() < 0.5:
        options["rowsperstrip"] = int(random.integers(1, 8))
    path = folder / "a.tif"
    tifffile.imwrite(str(path), pages, metadata=None, **options)
    ok = check("tiff %s" % options, path, folder, values, np.eye(4))
    if values.dtype in (np.uint8, np.uint16, np.float32) and values.ndim == 3:
        tifffile.imwrite(str(path), pages, imagej=True, resolution=(2, 2), metadata={"spacing": 1.5, "unit": "mm", "axes": "ZYX"})
        ok &= check("imagej", path, folder, values, np.diag([0.5, 0.5, 1.5, 1]))
    return ok


def judge_vtk(random, folder):
    from vtk.util import numpy_support
    values = random_array(random, [t for t in TYPES if t != "f2"], random.choice([None, 3, 2]))
    matrix = turned(random)
    spacing = np.linalg.norm(matrix[:3, :3], axis=0)
    low = [int(n) for n in random.integers(-20, 20, 3)]
    on_cells = bool(random.random() < 0.3) and min(values.shape[:3]) > 1
    image = vtk.vtkImageData()
    extent = []
    for k in range(3):
        extent += [low[k], low[k] + values.shape[k] - 1 + on_cells]
    image.SetExtent(extent)
    image.SetSpacing(*spacing)
    image.SetOrigin(*matrix[:3, 3])
    image.SetDirectionMatrix(*(matrix[:3, :3] / spacing).ravel())
    flat = np.ascontiguousarray(np.moveaxis(values, [0, 1, 2], [2, 1, 0])).reshape(-1, *values.shape[3:])
    array = numpy_support.numpy_to_vtk(flat, deep=True)
    array.SetName("field")
    (image.GetCellData() if on_cells else image.GetPointData()).AddArray(array)
    writer = vtk.vtkXMLImageDataWriter()
    writer.SetFileName(str(folder / "a.vti"))
    writer.SetInputData(image)
    [writer.SetDataModeToAscii, writer.SetDataModeToBinary, writer.SetDataModeToAppended][random.integers(3)]()
    if random.random() < 0.5:
        writer.SetByteOrderToBigEndian()
    [writer.SetCompressorTypeToNone, writer.SetCompressorTypeToZLib, writer.SetCompressorTypeToLZ4][random.integers(3)]()
    writer.Write()
    half = np.array([[1, 0, 0, .5], [0, 1, 0, .5], [0, 0, 1, .5], [0, 0, 0, 1]]) if on_cells else np.eye(4)
    ok = check("vti", folder / "a.vti", folder, values, matrix @ half, low=low, tolerance=1e-6)
    image.SetDirectionMatrix(np.eye(3).ravel().tolist())
    image.SetExtent([n - extent[i // 2 * 2] for i, n in enumerate(extent)])
    legacy = vtk.vtkStructuredPointsWriter()
    legacy.SetFileName(str(folder / "a.vtk"))
    legacy.SetInputData(image)
    legacy.SetFileType(int(random.integers(1, 3)))
    legacy.Write()
    matrix[:3, :3] = np.diag(spacing)
    return ok & check("vtk", folder / "a.vtk", folder, values, matrix @ half, tolerance=1e-5, digits=1e-4)


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 8
    judges = [judge_numpy] + [judge for judge, library in (
        (judge_nrrd, nrrd), (judge_nifti, nibabel), (judge_itk, sitk), (judge_tiff, tifffile), (judge_vtk, vtk)) if library]
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for i in range(count):
            for judge in judges:
                failed += not judge(np.random.default_rng([seed, i]), pathlib.Path(folder))
    print("%d files of %d libraries, %d failed" % (count * len(judges), len(judges), failed))
    return 1 if failed else 0


sys.exit(main())
