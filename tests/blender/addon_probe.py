# SPDX-License-Identifier: Apache-2.0
"""As probe.py, with the add-on of scripts/blender installed as Blender's preferences do it."""

import os
import sys
import time

import bpy

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import probe

MODULE = "tetvdb_import"


def install():
    bpy.ops.preferences.addon_install(
        filepath=os.path.join(os.environ["TETVDB_SCRIPTS"], "blender", MODULE + ".py"))
    bpy.ops.preferences.addon_enable(module=MODULE)
    bpy.context.preferences.addons[MODULE].preferences.program = os.environ["TETVDB_PROGRAM"]


def ask_state():
    """Before and after it is switched off and on again."""
    def state():
        entries = [each.__name__ for each in bpy.types.TOPBAR_MT_file_import._dyn_ui_initialize()]
        return {"menu": entries.count("menu_entry"),
                "operator": hasattr(bpy.types, "IMPORT_SCENE_OT_tetvdb")}

    on = state()
    bpy.ops.preferences.addon_disable(module=MODULE)
    off = state()
    install()
    return {"on": on, "off": off, "again": state()}


def described(material):
    nodes = {node.bl_idname: node for node in material.node_tree.nodes}
    inputs = {}
    for name, socket in nodes["ShaderNodeVolumePrincipled"].inputs.items():
        if socket.is_linked:
            inputs[name] = socket.links[0].from_node.bl_idname
        elif hasattr(socket, "default_value") and not hasattr(socket.default_value, "__len__"):
            inputs[name] = socket.default_value
        elif hasattr(socket, "default_value") and isinstance(socket.default_value, str):
            inputs[name] = socket.default_value
    answer = {"inputs": inputs, "attributes": [
        node.attribute_name for node in material.node_tree.nodes
        if node.bl_idname == "ShaderNodeAttribute"]}
    spread = nodes.get("ShaderNodeMapRange")
    if spread:
        answer["range"] = [spread.inputs["From Min"].default_value,
                           spread.inputs["From Max"].default_value]
        ramp = nodes["ShaderNodeValToRGB"].color_ramp
        answer["ramp"] = [list(ramp.evaluate(i / 20)) for i in range(21)]
    return answer


def without_scattering(material):
    """What is left has a formula: light that is sent out, and taken in on the way."""
    color = next(node for node in material.node_tree.nodes
                 if node.bl_idname == "ShaderNodeVolumePrincipled").inputs["Color"]
    for link in color.links:
        material.node_tree.links.remove(link)
    color.default_value = (0, 0, 0, 1)


def ask_import(options, pictures=(), frames=(), program=None, before=None):
    """Runs the operator: objects, materials, pictures; or what it says is wrong. `before`: options of
    an import in the same scene before, whose object is read, drawn and moved."""
    preferences = bpy.context.preferences.addons[MODULE].preferences
    preferences.program = os.environ["TETVDB_PROGRAM"] if program is None else program
    bpy.context.scene.frame_end = 1
    if before:
        bpy.ops.import_scene.tetvdb(**before)
        thing, = (each for each in bpy.data.objects if each.type == "VOLUME")
        probe.describe(thing.data)
        bpy.data.objects.remove(probe.surface_of(thing, "density", 0.5))
        thing.location = (7, 8, 9)
    try:
        result = bpy.ops.import_scene.tetvdb(**options)
    except RuntimeError as error:
        return {"error": str(error), "objects": [each.name for each in bpy.data.objects]}
    answer = {"result": list(result), "objects": [], "volumes": len(bpy.data.volumes), "frame_end": bpy.context.scene.frame_end}
    for thing in bpy.data.objects:
        each = {"name": thing.name, "type": thing.type, "location": list(thing.location),
                "scale": list(thing.scale), "selected": thing.select_get()}
        if thing.type == "VOLUME":
            each.update(probe.sequence_of(thing), mode=thing.data.sequence_mode,
                        **probe.describe(thing.data),
                        materials=[described(m) for m in thing.data.materials])
        else:
            each["surface"] = probe.measure(thing)
        answer["objects"].append(each)
    volume = next(each for each in bpy.data.objects if each.type == "VOLUME")
    if frames:
        surface = probe.surface_of(volume, "density", 0.5)
        answer["frames"] = [probe.frame_of(volume, surface, frame) for frame in frames]
        bpy.data.objects.remove(surface)
    for material in volume.data.materials:
        without_scattering(material)
    for picture in pictures:
        probe.render(**picture)
    return answer


def ask_tiles(path, **options):
    """Runs the operator for tiles: what is in its collection, each tile's surface among it."""
    try:
        result = bpy.ops.import_scene.tetvdb_tiles(filepath=path, **options)
    except RuntimeError as error:
        return {"error": str(error), "objects": [each.name for each in bpy.data.objects]}
    collection, = (each for each in bpy.data.collections if each.objects)
    tiles = list(collection.objects)
    answer = {"result": list(result), "collection": collection.name, "tiles": []}
    for thing in tiles:
        surface = probe.surface_of(thing, "density", 0.5)
        answer["tiles"].append({
            "name": thing.name, "location": list(thing.location), "scale": list(thing.scale),
            "selected": thing.select_get(), "materials": [m.name for m in thing.data.materials],
            "surface": probe.measure(surface), **probe.describe(thing.data)})
        bpy.data.objects.remove(surface)
    for each in list(bpy.data.collections):
        bpy.data.collections.remove(each)
    return answer


def ask_cancel(path, output):
    """Starts a job that takes long, looks at its progress, and stops it."""
    module = sys.modules[MODULE]
    job = module.Job(os.environ["TETVDB_PROGRAM"],
                     lambda folder: ["voxelize", path, "-o", output, "--resolution", "3000",
                                     "--grid", "coverage,surface"])
    started = time.monotonic()
    while not job.stage and time.monotonic() < started + 20:
        time.sleep(0.01)
    stage, folder = job.stage, job.folder.name
    job.cancel()
    try:
        job.finish()
        error = ""
    except module.TetvdbError as raised:
        error = str(raised)
    return {"stage": stage, "text": error, "seconds": time.monotonic() - started,
            "left": os.path.exists(folder)}


def ask_progress(path, output):
    """The stages and fractions that a whole job goes through."""
    module = sys.modules[MODULE]
    job = module.Job(os.environ["TETVDB_PROGRAM"],
                     lambda folder: ["voxelize", path, "-o", output, "--resolution", "500",
                                     "--grid", "coverage"])
    seen = set()
    while job.running():
        seen.add((job.stage, job.fraction))
        time.sleep(0.002)
    report = job.finish()
    return {"seen": sorted(seen), "said": job.said, "status": report["status"]}


if __name__ == "__main__":
    install()
    probe.main(globals(), *sys.argv[sys.argv.index("--") + 1:])
