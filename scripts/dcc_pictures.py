# SPDX-License-Identifier: Apache-2.0
"""Makes the pictures of docs/dcc.md in Blender, from volumes that tetvdb makes:

    TETVDB_PROGRAM=build/release/bin/tetvdb \\
    blender -b --factory-startup --python-exit-code 1 --python scripts/dcc_pictures.py -- docs/images

Models: the quadcopter frame of tests/data, and a pipe's elbow of hexahedra whose wall is heated from
within. Takes about a minute on two cores.
"""

import math
import os
import sys
import tempfile

import bpy
import mathutils
import numpy

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(ROOT, "scripts", "blender"))
import tetvdb_import

WIDTH, HEIGHT = 480, 320
ALONG, AROUND, ACROSS = 60, 48, 6
BEND, OUTER, INNER = 1.0, 0.42, 0.26
TURN = 1.25 * math.pi


def elbow(time):
    """A pipe of hexahedra bent through TURN, as .vtu. A hot plug passes through it with time."""
    points, heat = [], []
    for i in range(ALONG + 1):
        turn = TURN * i / ALONG
        for j in range(AROUND + 1):
            angle = 2 * math.pi * (j % AROUND) / AROUND
            for k in range(ACROSS + 1):
                radius = INNER + (OUTER - INNER) * k / ACROSS
                reach = BEND + radius * math.cos(angle)
                points.append((reach * math.cos(turn), reach * math.sin(turn),
                               radius * math.sin(angle)))
                # Along the inside of the bend the wall is hotter.
                place = turn / TURN + 0.08 * math.cos(angle) + 0.06 * math.sin(3 * angle)
                wave = math.exp(-((place - time) / 0.22) ** 2)
                heat.append(300 + 500 * wave * (1 - 0.5 * k / ACROSS))
    at = lambda i, j, k: (i * (AROUND + 1) + j) * (ACROSS + 1) + k
    cells = [[at(i + a, j + b, k + c) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
             for i in range(ALONG) for j in range(AROUND) for k in range(ACROSS)]

    def array(name, kind, numbers, components=1):
        text = " ".join(map(str, numbers))
        return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" '
                f'format="ascii">{text}</DataArray>')

    return (f'<VTKFile type="UnstructuredGrid" version="0.1"><UnstructuredGrid>'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"><Points>'
            + array("points", "Float64", (x for p in points for x in p), 3) + "</Points><Cells>"
            + array("connectivity", "Int64", (x for cell in cells for x in cell))
            + array("offsets", "Int64", (8 * (i + 1) for i in range(len(cells))))
            + array("types", "UInt8", (12 for _ in cells)) + "</Cells><PointData>"
            + array("temperature", "Float32", heat)
            + "</PointData></Piece></UnstructuredGrid></VTKFile>")


def background(scene):
    return next(n for n in scene.world.node_tree.nodes if n.bl_idname == "ShaderNodeBackground")


def empty_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.use_denoising = False
    scene.cycles.diffuse_bounces = 1
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_percentage = 100
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    background(scene).inputs[0].default_value = (0.02, 0.025, 0.035, 1)
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy, sun.rotation_euler = 3, (0.7, 0.3, 0.4)
    scene.collection.objects.link(sun)
    return scene


def render(scene, path, centre, away, width, samples, size=(WIDTH, HEIGHT)):
    """From the direction `away`, `width` units wide, as an array of rows from below."""
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type, camera.data.ortho_scale = "ORTHO", width
    away = mathutils.Vector(away).normalized()
    camera.location = mathutils.Vector(centre) + away * 10 * width
    camera.data.clip_start, camera.data.clip_end = width, 30 * width
    camera.rotation_euler = away.to_track_quat("Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.cycles.samples = samples
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100
    scene.render.dither_intensity = 0  # noise, to a PNG
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def picture_of_solid(folder, images):
    """The quadcopter's frame, in metres: its level set as a mesh, by Volume to Mesh."""
    scene = empty_scene()
    bpy.ops.import_scene.tetvdb(
        filepath=os.path.join(ROOT, "tests", "data", "quadcopter_frame.mesh"),
        output=os.path.join(folder, "frame.vdb"), resolution=500, surface=True, scale=10,
        shading="NONE", more="--up-axis y")
    volume = bpy.data.objects["quadcopter_frame"]
    volume.hide_render = True
    metal = bpy.data.materials.new("metal")
    metal.use_nodes = True
    nodes = metal.node_tree.nodes
    nodes.clear()
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    metal.node_tree.links.new(shader.outputs["BSDF"],
                              nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    shader.inputs["Base Color"].default_value = (0.9, 0.45, 0.12, 1)
    shader.inputs["Roughness"].default_value = 0.4
    surface = bpy.data.objects["quadcopter_frame surface"]
    # A mesh without faces of its own takes the material from its slot.
    surface.data.materials.append(metal)
    box = numpy.array([volume.matrix_world @ mathutils.Vector(c) for c in volume.bound_box])
    background(scene).inputs[0].default_value = (0.25, 0.27, 0.3, 1)
    render(scene, os.path.join(images, "dcc-solid.png"), (box.min(0) + box.max(0)) / 2,
           (0.5, -1, 0.9), 2.6, 64)


def pictures_of_field(folder, images):
    """The elbow's temperature over time: four frames side by side."""
    names = []
    for frame in range(4):
        path = os.path.join(folder, f"elbow_{frame + 1}.vtu")
        with open(path, "w") as file:
            file.write(elbow(0.1 + 0.27 * frame))
        names.append({"name": os.path.basename(path)})
    scene = empty_scene()
    bpy.ops.import_scene.tetvdb(filepath=path, directory=folder, files=names, arrays="temperature",
                                resolution=160)
    # Only emission, without scattering: this has no noise and renders fast.
    for node in bpy.context.object.data.materials[0].node_tree.nodes:
        if node.bl_idname == "ShaderNodeVolumePrincipled":
            color = node.inputs["Color"]
            node.id_data.links.remove(color.links[0])
            color.default_value = (0, 0, 0, 1)
    parts = []
    for frame in range(4):
        scene.frame_set(frame + 1)
        part = os.path.join(folder, f"part{frame}.png")
        render(scene, part, (-0.05, 0.1, 0.0), (0.35, -0.5, 1.0), 3.3, 16, (240, 200))
        image = bpy.data.images.load(part)
        parts.append(numpy.array(image.pixels[:]).reshape(200, 240, 4))
    strip = numpy.concatenate(parts, axis=1)
    image = bpy.data.images.new("strip", strip.shape[1], strip.shape[0])
    image.pixels = strip.ravel().tolist()
    image.filepath_raw, image.file_format = os.path.join(images, "dcc-sequence.png"), "PNG"
    image.save()


def main(images):
    os.makedirs(images, exist_ok=True)
    tetvdb_import.register()
    with tempfile.TemporaryDirectory(prefix="tetvdb-pictures-") as folder:
        picture_of_solid(folder, images)
        pictures_of_field(folder, images)


if __name__ == "__main__":
    program = os.environ.get("TETVDB_PROGRAM")
    if program:
        os.environ["PATH"] = os.path.dirname(os.path.abspath(program)) + os.pathsep \
            + os.environ["PATH"]
    main(os.path.abspath(sys.argv[sys.argv.index("--") + 1]))
