# SPDX-License-Identifier: Apache-2.0
"""What Blender makes of volumes. Runs inside Blender:

    blender -b --factory-startup --python-exit-code 1 --python probe.py -- QUESTIONS.json ANSWERS.json

QUESTIONS is a list of objects with the key `ask` (a function below, without `ask_`) and its
arguments; ANSWERS has their results in the same order, or {"exception": TEXT}. Nothing is judged
here, and nothing of TetVDB is used.
"""

import json
import math
import os
import sys
import traceback

import bmesh
import bpy
import numpy

# Orthographic views: rotation of the camera, and the world axes to which the picture's columns,
# rows (from below) and the way towards the camera run.
VIEWS = {"x": ((math.pi / 2, 0, math.pi / 2), (1, 2, 0), +1),
         "y": ((math.pi / 2, 0, 0), (0, 2, 1), -1),
         "z": ((0, 0, 0), (0, 1, 2), +1)}


def clear():
    scene = bpy.context.scene
    for collection in (bpy.data.objects, bpy.data.volumes, bpy.data.meshes, bpy.data.materials,
                       bpy.data.cameras, bpy.data.lights):
        for item in list(collection):
            collection.remove(item)
    scene.frame_set(1)


def add_volume(path):
    volume = bpy.data.volumes.new("volume")
    volume.filepath = path
    thing = bpy.data.objects.new("volume", volume)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def describe(volume):
    volume.grids.load()
    grids = []
    for grid in volume.grids:
        loaded = grid.load()
        grids.append({"name": grid.name, "type": grid.data_type, "channels": grid.channels,
                      "loaded": bool(loaded and grid.is_loaded),
                      "matrix": [list(row) for row in grid.matrix_object]})
    return {"error": volume.grids.error_message, "grids": grids,
            "velocity": volume.velocity_grid, "velocity_unit": volume.velocity_unit}


def ask_list(path):
    """The grids of a file."""
    return describe(add_volume(path).data)


def surface_of(volume_object, grid, threshold):
    mesh = bpy.data.meshes.new("surface")
    thing = bpy.data.objects.new("surface", mesh)
    bpy.context.scene.collection.objects.link(thing)
    modifier = thing.modifiers.new("surface", "VOLUME_TO_MESH")
    modifier.object = volume_object
    modifier.grid_name = grid
    modifier.threshold = threshold
    modifier.resolution_mode = "GRID"
    modifier.adaptivity = 0
    return thing


def measure(surface):
    evaluated = surface.evaluated_get(bpy.context.evaluated_depsgraph_get())
    made = bmesh.new()
    made.from_mesh(evaluated.to_mesh())
    points = numpy.array([v.co[:] for v in made.verts]).reshape(-1, 3)
    # Blender's own volume is a float.
    volume, moment = 0.0, numpy.zeros(3)
    for face in made.faces:
        a, *rest = (points[v.index] for v in face.verts)
        for b, c in zip(rest, rest[1:]):
            part = numpy.dot(a, numpy.cross(b, c)) / 6
            volume += part
            moment += part * (a + b + c) / 4
    answer = {"vertices": len(points), "faces": len(made.faces), "volume": volume,
              "open_edges": sum(1 for edge in made.edges if not edge.is_manifold),
              "box": [points.min(0).tolist(), points.max(0).tolist()] if len(points) else None,
              "centroid": (moment / volume).tolist() if volume else None}
    made.free()
    evaluated.to_mesh_clear()
    return answer


def ask_surface(path, grid, threshold):
    """Volume to Mesh at the grid's own resolution."""
    return measure(surface_of(add_volume(path), grid, threshold))


def material(kind, grid, gain, times=None):
    """`emission`: a pixel is the integral of the grid along the ray, times gain, and times another
    grid. `absorption`: what comes through of a background of 1. `color`: emission in the colour of
    a vector grid, which does not fade at the boundary, times gain or the other grid."""
    made = bpy.data.materials.new(kind)
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    attribute = tree.nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = grid
    factor = tree.nodes.new("ShaderNodeMath")
    factor.operation = "MULTIPLY"
    factor.inputs[1].default_value = gain
    tree.links.new(attribute.outputs["Fac"], factor.inputs[0])
    if times:
        other = tree.nodes.new("ShaderNodeAttribute")
        other.attribute_name = times
        tree.links.new(other.outputs["Fac"], factor.inputs[1])
    if kind == "absorption":
        shader = tree.nodes.new("ShaderNodeVolumeAbsorption")
        shader.inputs["Color"].default_value = (0, 0, 0, 1)
        tree.links.new(factor.outputs[0], shader.inputs["Density"])
    else:
        shader = tree.nodes.new("ShaderNodeEmission")
        tree.links.new(factor.outputs[0], shader.inputs["Strength"])
        if kind == "color":
            tree.links.new(attribute.outputs["Color"], shader.inputs["Color"])
            factor.inputs[0].default_value = 1
            tree.links.remove(factor.inputs[0].links[0])
    tree.links.new(shader.outputs[0], output.inputs["Volume"])
    return made


def render(save, view, centre, width, pixels, samples=32, background=0.0, frame=1):
    """An orthographic picture of `width` units and `pixels` a side, as floats, in `save` (.npy):
    rows from below, columns from the left."""
    scene = bpy.context.scene
    rotation, axes, side = VIEWS[view]
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = width
    camera.data.clip_start, camera.data.clip_end = width * 1e-3, width * 100
    camera.rotation_euler = rotation
    camera.location = centre
    camera.location[axes[2]] += side * width * 10
    scene.collection.objects.link(camera)
    scene.camera = camera
    if scene.world is None:
        scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (background,) * 3 + (1,)
    scene.world.node_tree.nodes["Background"].inputs[1].default_value = 1
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = samples
    scene.cycles.use_denoising = False
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 1
    scene.cycles.sample_clamp_indirect = 0
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.render.resolution_percentage = 100
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    picture = os.path.splitext(save)[0] + ".exr"
    scene.render.filepath = picture
    scene.frame_set(frame)
    print("picture", save, flush=True)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(picture)
    values = numpy.array(image.pixels[:], dtype=numpy.float32).reshape(pixels, pixels, 4)
    bpy.data.images.remove(image)
    os.remove(picture)
    numpy.save(save, values[..., :3])
    return {"picture": save}


def ask_render(path, grid, kind="emission", gain=1.0, times=None, **picture):
    thing = add_volume(path)
    thing.data.materials.append(material(kind, grid, gain, times))
    return render(**picture)


def import_volumes(paths):
    """As File > Import > OpenVDB does with these files selected: what came of it."""
    bpy.ops.object.volume_import(
        filepath=paths[0], directory=os.path.dirname(paths[0]), relative_path=False,
        files=[{"name": os.path.basename(path)} for path in paths], use_sequence_detection=True)
    return [thing for thing in bpy.data.objects if thing.type == "VOLUME"]


def sequence_of(thing):
    volume = thing.data
    return {"name": thing.name, "file": os.path.basename(volume.filepath),
            "is_sequence": volume.is_sequence, "frames": volume.frame_duration,
            "start": volume.frame_start, "offset": volume.frame_offset}


def frame_of(thing, surface, frame):
    bpy.context.scene.frame_set(frame)
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    evaluated.data.grids.load()
    answer = {"file": os.path.basename(evaluated.data.grids.frame_filepath),
              "error": evaluated.data.grids.error_message,
              "grids": [grid.name for grid in evaluated.data.grids]}
    return {**answer, **measure(surface)}


def ask_sequence(paths, grid, threshold, frames, pictures=()):
    """Imports the files; what each object is, and the first one's surface in each frame."""
    things = import_volumes(paths)
    surface = surface_of(things[0], grid, threshold)
    answer = {"objects": sorted((sequence_of(thing) for thing in things),
                                key=lambda each: each["file"]),
              "frames": [frame_of(things[0], surface, frame) for frame in frames]}
    bpy.data.objects.remove(surface)
    things[0].data.materials.append(material("emission", grid, 1))
    for picture in pictures:
        render(**picture)
    return answer


def main(functions, questions, answers):
    results = []
    with open(questions) as file:
        asked = json.load(file)
    for question in asked:
        clear()
        try:
            name = "ask_" + question.pop("ask")
            results.append(functions[name](**question))
        except Exception:  # the test that asked reports it
            results.append({"exception": traceback.format_exc()})
    with open(answers, "w") as file:
        json.dump(results, file)


if __name__ == "__main__":
    main(globals(), *sys.argv[sys.argv.index("--") + 1:])
