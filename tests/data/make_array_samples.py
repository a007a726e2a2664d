# SPDX-License-Identifier: Apache-2.0
"""Makes the samples of arrays/: 3 x 4 x 5 voxels of the value x + 10 y + 100 z, by the formats' own
libraries (NumPy, pynrrd, nibabel, tifffile with imagecodecs, SimpleITK, VTK).

    make_array_samples.py [numpy|nrrd|nifti|tiff|itk|vtk...]

The voxels are 0.5 wide along x, 1 along y and 2 along z where the format says so, and voxel (0, 0, 0) is at
(1, 2, 3).
"""

import pathlib
import sys

import numpy as np

HERE = pathlib.Path(__file__).parent / "arrays"
x, y, z = np.indices((3, 4, 5))
VALUES = x + 10 * y + 100 * z
PLACE = np.array([[0.5, 0, 0, 1], [0, 1, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1.0]])


def numpy_files():
    np.save(HERE / "c_order.npy", VALUES.astype("<f4"))
    np.save(HERE / "fortran_big.npy", np.asfortranarray(VALUES.astype(">i2")))
    np.savez_compressed(HERE / "packed.npz", field=VALUES.astype("<f8"), labels=np.arange(3))


def nrrd_files():
    import nrrd
    header = {"space": "left-posterior-superior", "space directions": PLACE[:3, :3], "space origin": PLACE[:3, 3]}
    for encoding in ("raw", "gzip", "ascii"):
        nrrd.write(str(HERE / (encoding + ".nrrd")), VALUES.astype("<u2"), dict(header, encoding=encoding))
    nrrd.write(str(HERE / "beside.nhdr"), VALUES.astype("<i4"), dict(header, encoding="raw"))


def nifti_files():
    import nibabel
    nibabel.save(nibabel.Nifti1Image(VALUES.astype("<i2"), PLACE), HERE / "one.nii")
    nibabel.save(nibabel.Nifti2Image(VALUES.astype("<f4"), PLACE), HERE / "two.nii.gz")


def tiff_files():
    import tifffile
    pages = VALUES.transpose(2, 1, 0)
    tifffile.imwrite(HERE / "imagej.tif", pages.astype("<u2"), imagej=True, resolution=(2, 1),
                     metadata={"spacing": 2.0, "unit": "mm", "axes": "ZYX"})
    for name, options in {"lzw": {"compression": "lzw", "predictor": True}, "packbits": {"compression": "packbits"},
                          "tiles": {"compression": "zlib", "tile": (16, 16), "bigtiff": True},
                          "strips": {"rowsperstrip": 3, "byteorder": ">"}}.items():
        tifffile.imwrite(HERE / (name + ".tif"), pages.astype("u2"), metadata=None, photometric="minisblack", **options)


def itk_files():
    import SimpleITK
    image = SimpleITK.GetImageFromArray(VALUES.transpose(2, 1, 0).astype("<i2"))
    image.SetSpacing((0.5, 1, 2))
    image.SetOrigin((1, 2, 3))
    SimpleITK.WriteImage(image, str(HERE / "packed.mha"), True)


def vtk_files():
    import vtk
    from vtk.util import numpy_support
    image = vtk.vtkImageData()
    image.SetDimensions(3, 4, 5)
    image.SetSpacing(0.5, 1, 2)
    image.SetOrigin(1, 2, 3)
    array = numpy_support.numpy_to_vtk(VALUES.transpose(2, 1, 0).astype("<f4").ravel(), deep=True)
    array.SetName("field")
    image.GetPointData().SetScalars(array)
    writer = vtk.vtkXMLImageDataWriter()
    for name in ("ascii", "binary", "appended"):
        writer.SetFileName(str(HERE / (name + ".vti")))
        writer.SetInputData(image)
        getattr(writer, "SetDataModeTo" + name.capitalize())()
        writer.Write()
    legacy = vtk.vtkStructuredPointsWriter()
    for name, kind in (("points_text", 1), ("points_binary", 2)):
        legacy.SetFileName(str(HERE / (name + ".vtk")))
        legacy.SetInputData(image)
        legacy.SetFileType(kind)
        legacy.Write()


# With names of libraries, those alone.
for make in (numpy_files, nrrd_files, nifti_files, tiff_files, itk_files, vtk_files):
    if len(sys.argv) == 1 or make.__name__[:-6] in sys.argv:
        make()
