"""Files that are dropped on the page, or chosen, become its scene."""

import json
import struct

import pytest

# Drops files on the page: pairs of a name and bytes.
DROP = """files => {
  const data = new DataTransfer();
  for (const [name, bytes] of files) data.items.add(new File([new Uint8Array(bytes)], name));
  for (const kind of ['dragover', 'drop']) {
    const event = new DragEvent(kind, { dataTransfer: data, bubbles: true, cancelable: true });
    document.querySelector('main').dispatchEvent(event);
  }
}"""
OBJ = b"mtllib a.mtl\nv -1 0 0\nv 1 0 0\nv 1 1 0\nv -1 1 0\nusemtl red\nf 1 2 3 4\n"
MTL = b"newmtl red\nKd 0.9 0.1 0.1\n"
SCENE = {
    "format": 2,
    "name": "written",
    "film": {"width": 40, "height": 30},
    "camera": {"origin": [0, 0.5, 4], "target": [0, 0.5, 0], "up": [0, 1, 0], "fov_y": 40},
    "background": [1, 1, 1],
    "meshes": [{"file": "a.obj"}],
}


def glb():
    """A glTF of one triangle that is green, as one file."""
    positions = struct.pack("<9f", -1, 0, 0, 1, 0, 0, 0, 1.5, 0)
    green = {"pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.8, 0.1, 1], "metallicFactor": 0}}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "materials": [green],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "accessors": [{
            "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
            "min": [-1, 0, 0], "max": [1, 1.5, 0],
        }],
        "bufferViews": [{"buffer": 0, "byteLength": len(positions)}],
        "buffers": [{"byteLength": len(positions)}],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    chunks += struct.pack("<II", len(positions), 0x004E4942) + positions
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def drop(page, *files):
    page.tab.evaluate(DROP, [[name, list(content)] for name, content in files])


def middle(page):
    """Red, green and blue in the middle of the picture."""
    return page.tab.evaluate(
        """() => [...picture.getContext('2d')
          .getImageData(picture.width / 2, picture.height / 2, 1, 1).data.slice(0, 3)]"""
    )


def wait_for_scene(page, part):
    """Waits until the page shows a picture of the scene of whose note this is a part."""
    page.wait("part => document.getElementById('scene-note').textContent.includes(part)", part)
    # Pictures come in the order of the orders: the next one is of this scene.
    page.tab.evaluate("document.documentElement.dataset.samples = 0")
    page.wait_for_samples(2)


def test_a_glb_that_is_dropped_is_rendered(visit):
    page = visit()
    page.wait_for_samples(1)
    drop(page, ("leaf.glb", glb()))
    wait_for_scene(page, ". 1 triangle.")
    assert page.tab.locator("#scene").input_value() == "leaf.glb"
    assert page.tab.locator("#drop-note").is_hidden()
    red, green, blue = middle(page)
    assert green > 2 * red and green > 2 * blue
    page.screenshot("dropped")
    page.tab.locator("#to-method").click()
    page.wait("document.getElementById('method').dataset.round === '1'")


@pytest.mark.parametrize("names, scene", [
    (["a.obj", "a.mtl"], "a.obj"), (["a.mtl", "written.json", "a.obj"], "written.json"),
])
def test_files_that_are_chosen_together_are_a_scene(visit, names, scene):
    content = {"a.obj": OBJ, "a.mtl": MTL, "written.json": json.dumps(SCENE).encode()}
    page = visit()
    page.wait_for_samples(1)
    files = [{"name": name, "mimeType": "", "buffer": content[name]} for name in names]
    page.tab.locator("#files").set_input_files(files)
    wait_for_scene(page, ". 2 triangles.")
    assert page.tab.locator("#scene").input_value() == scene
    red, green, blue = middle(page)
    assert red > 2 * green and red > 2 * blue
    # The scenes that ship are there still, and so is this one.
    page.tab.locator("#scene").select_option("opening")
    page.wait("!document.getElementById('scene-note').textContent.includes('. 2 triangles.')")
    page.tab.locator("#scene").select_option(scene)
    wait_for_scene(page, ". 2 triangles.")


@pytest.mark.parametrize("files, part", [
    ([("broken.glb", b"glTF and no more")], "broken.glb"),
    ([("a.txt", b"words")], "no scene among a.txt"),
    ([("a.glb", glb()), ("b.glb", glb())], "a.glb, b.glb are scenes"),
    ([("scene.json", json.dumps(SCENE).encode())], "a.obj"),
])
def test_what_is_wrong_with_files_is_said_by_name(visit, files, part):
    page = visit()
    page.wait_for_samples(1)
    drop(page, *files)
    page.wait("part => document.getElementById('problem').textContent.includes(part)", part)
    page.tab.locator("#scene").select_option("opening")
    page.wait("document.getElementById('problem').hidden")
    page.wait_for_samples(1)
