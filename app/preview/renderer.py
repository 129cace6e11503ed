"""The one renderer: pyrender behind a class of our own, used only by the thread that made it."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import numpy.typing as npt

from app.preview.camera import FIELD_OF_VIEW_DEG, Camera
from app.preview.lighting import Lighting, to_linear
from app.preview.parts import eyeballs, part_of, shell_and_rest
from engine.character import Character
from engine.errors import EngineError
from engine.framing import framed
from engine.take import Array

if sys.platform == "linux":
    os.environ.setdefault("PYOPENGL_PLATFORM", "egl")

Triangles = npt.NDArray[np.int32]  # (n, 3)
Picture = npt.NDArray[np.uint8]  # (height, width, 3) sRGB
GROUND = (0x23, 0x27, 0x2E)
_GROUND = np.array(GROUND, np.float32) / 255.0
NECK_FADE = 0.3  # parts of the head's height over which the neck's cut end dissolves into the ground
SAMPLES = 4
HEAT_FULL_MM = 10.0
STAGES = 3  # characters whose buffers are kept: source, target and one that was shown before
# From still to far: a ramp of rising lightness that reads in grey and for colour-blind eyes too.
HEAT = np.array([(52, 56, 66), (52, 84, 140), (86, 180, 233), (240, 228, 66), (255, 250, 225)], np.float64)


@dataclass(frozen=True, eq=False)
class Shot:
    """What to draw.

    Attributes
    ----------
    faces : weights, (52,) each; two or more stand side by side; None leaves a side empty
    heads : whose head each face is on; the renderer's own where there is none
    camera : seen from where
    size : width and height in pixels
    compared_to : weights, (52,), whose distance to the face is painted on it in mm
    smooth_edges : four samples a pixel; without, a picture takes half the time
    """

    faces: tuple[Array | None, ...]
    camera: Camera = field(default_factory=Camera)
    size: tuple[int, int] = (512, 512)
    compared_to: Array | None = None
    smooth_edges: bool = True
    heads: tuple[Character | None, ...] = ()


def heat(moved_mm: Array) -> npt.NDArray[np.uint8]:
    """Return sRGB colours, (n, 3), of distances, (n,) in mm, full at HEAT_FULL_MM."""
    at = np.clip(moved_mm / HEAT_FULL_MM, 0.0, 1.0) * (len(HEAT) - 1)
    return np.stack([np.interp(at, np.arange(len(HEAT)), channel) for channel in HEAT.T], axis=1).astype(np.uint8)


class _Stage:
    """One character in the scene: its buffers, its light, and the box that the camera frames.

    Parameters
    ----------
    character : what stands on it
    scene : where its meshes are put, unseen until it is drawn
    """

    def __init__(self, character: Character, scene: Any) -> None:
        pyrender = _pyrender()
        part = part_of(character)
        self.character, self._lighting, self._scene = character, Lighting(character, eyeballs(character, part)), scene
        neutral = character.neutral
        self.low, self.high = framed(character)
        height = self.high[1] - self.low[1]
        rise = (neutral[:, 1] - (self.low[1] - NECK_FADE / 2 * height)) / (NECK_FADE * height)
        self._solid = np.clip(rise, 0.0, 1.0)[:, None].astype(np.float32)
        closed, open_ = shell_and_rest(character, part)
        self._primitives = [
            pyrender.Primitive(
                positions=neutral.astype(np.float32),
                indices=triangles.astype(np.uint32),
                color_0=np.ones((len(neutral), 4), np.float32),
                # floats: integers would be taken as 0..255 and draw black
                material=pyrender.MetallicRoughnessMaterial(baseColorFactor=[1.0, 1.0, 1.0, 1.0], doubleSided=both),
            )
            for triangles, both in ((closed, False), (open_, True))
            if len(triangles)
        ]
        self.mesh = pyrender.Mesh(self._primitives, is_visible=False)
        self._node = scene.add(self.mesh)
        self._vertex_rows = np.ones((len(neutral), 7), np.float32)  # position, colour: the layout of the buffer

    def pose(self, weights: Array, eye: Array, compared_to: Array | None) -> None:
        """Bring the buffers to a face, (52,) weights, as it is seen from `eye`, (3,); a context must be current."""
        vertices = self.character.vertices(weights)
        colours = None
        if compared_to is not None:
            moved = np.linalg.norm(vertices - self.character.vertices(compared_to), axis=1)
            colours = to_linear(heat(moved))
        self._vertex_rows[:, :3] = vertices
        lit = self._lighting.shade(vertices, eye.astype(np.float32), colours)
        self._vertex_rows[:, 3:6] = _GROUND + self._solid * (lit - _GROUND)
        self._upload()

    def _upload(self) -> None:
        """Write the vertex buffer in place: pyrender itself reads positions only once, before the first drawing."""
        from OpenGL.GL import GL_ARRAY_BUFFER, glBindBuffer, glBufferSubData

        for primitive in self._primitives:
            if not primitive._buffers:
                primitive.positions = self._vertex_rows[:, :3].copy()
                primitive.color_0 = self._vertex_rows[:, 3:].copy()
                continue
            glBindBuffer(GL_ARRAY_BUFFER, primitive._buffers[0])
            glBufferSubData(GL_ARRAY_BUFFER, 0, self._vertex_rows.nbytes, self._vertex_rows)
        glBindBuffer(GL_ARRAY_BUFFER, 0)

    def leave(self) -> None:
        """Take the character off the scene."""
        self._scene.remove_node(self._node)


class Renderer:
    """Draws characters; raises `EngineError` where there is no OpenGL to draw with.

    Parameters
    ----------
    character : whose head a face is on where a shot names no other
    """

    def __init__(self, character: Character) -> None:
        pyrender = _pyrender()
        self.character = character
        self._flags = pyrender.RenderFlags.FLAT
        self._scene = pyrender.Scene(bg_color=[*(value / 255 for value in GROUND), 1.0])
        self._stages: list[_Stage] = []  # the one drawn last comes last
        self._camera = pyrender.PerspectiveCamera(yfov=np.radians(FIELD_OF_VIEW_DEG), znear=50.0, zfar=6000.0)
        self._camera_node = self._scene.add(self._camera, pose=np.eye(4))
        try:
            self._target = pyrender.OffscreenRenderer(64, 64)
        except Exception as error:  # each platform fails with errors of its own
            raise EngineError(
                f"The preview cannot be drawn: {error or type(error).__name__}.", "Editing works without it."
            ) from error
        self._samples = _Samples(self._target._renderer)
        _skip_depth(self._target._renderer)

    @property
    def device(self) -> str:
        """The name of what draws, as OpenGL gives it."""
        from OpenGL.GL import GL_RENDERER, glGetString

        self._target._platform.make_current()
        name = glGetString(GL_RENDERER)
        return name.decode(errors="replace") if name else "unknown"

    def draw(self, shot: Shot) -> Picture:
        """Return the picture of a shot, (height, width, 3)."""
        width, height = (max(16, edge) for edge in shot.size)
        self._target._platform.make_current()
        self._samples.use(SAMPLES if shot.smooth_edges else 0)
        borders = np.linspace(0, width, len(shot.faces) + 1).round().astype(int)
        heads = shot.heads or (None,) * len(shot.faces)
        panels = [
            self._panel(weights, head or self.character, shot, (int(right - left), height))
            for weights, head, left, right in zip(shot.faces, heads, borders, borders[1:], strict=False)
        ]
        return panels[0] if len(panels) == 1 else np.concatenate(panels, axis=1)

    def _panel(self, weights: Array | None, head: Character, shot: Shot, size: tuple[int, int]) -> Picture:
        width, height = size
        if weights is None:
            return np.full((height, width, 3), GROUND, np.uint8)
        stage = self._stage(head)
        pose = shot.camera.pose(stage.low, stage.high, aspect=width / height)
        stage.pose(weights, pose[:3, 3], shot.compared_to)
        self._scene.set_pose(self._camera_node, pose)
        self._target.viewport_width, self._target.viewport_height = width, height
        stage.mesh.is_visible = True
        try:
            return np.asarray(self._target.render(self._scene, flags=self._flags))
        finally:
            stage.mesh.is_visible = False

    def _stage(self, head: Character) -> _Stage:
        """Return the stage of a character; the one that was not drawn for longest makes room for a new one."""
        stage = next((each for each in self._stages if each.character is head), None)
        if stage is None:
            stage = _Stage(head, self._scene)
        else:
            self._stages.remove(stage)
        self._stages.append(stage)
        if len(self._stages) > STAGES:
            self._stages.pop(0).leave()
        return stage

    def close(self) -> None:
        """Give back what OpenGL holds."""
        self._target.delete()


def _pyrender() -> Any:
    # pyrender 0.1.45 was written for numpy 1, which had this second name for infinity. Its maintained forks of the same
    # import name, pyrender2 0.2.2 and pyrender-maintained 1.0.1, have dropped it: with either, these two lines can go, and
    # so can `six` and the exception for PyOpenGL in packaging/overrides.txt. All pictures and the tests of the preview come
    # out alike on both. The other patches here they leave as needful: writing vertices in place, the number of samples,
    # and reading the depth.
    if not hasattr(np, "infty"):
        np.infty = np.inf  # type: ignore[attr-defined]  # noqa: NPY201
    import pyrender

    return pyrender


class _Samples:
    """How often each pixel is sampled, which pyrender fixes at four: its frame buffer is made anew for another number."""

    def __init__(self, renderer: Any) -> None:
        from pyrender import renderer as module

        self._renderer, self._count = renderer, SAMPLES
        make = module.glRenderbufferStorageMultisample
        self._renderer._configure_main_framebuffer = self._configure
        self._module, self._make = module, make

    def use(self, count: int) -> None:
        """Sample each pixel this often from the next picture on; a context must be current."""
        if count != self._count:
            self._count = count
            self._renderer._delete_main_framebuffer()

    def _configure(self) -> None:
        self._module.glRenderbufferStorageMultisample = lambda kind, _, *size: self._make(kind, self._count, *size)
        try:
            type(self._renderer)._configure_main_framebuffer(self._renderer)
        finally:
            self._module.glRenderbufferStorageMultisample = self._make


def _skip_depth(renderer: Any) -> None:
    """Read back colour alone: the depth picture costs as much to read and nobody looks at it."""
    from OpenGL import GL

    def read_colour(scene: object, flags: int) -> Picture:
        width, height = renderer._main_fb_dims
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb_ms)
        GL.glBindFramebuffer(GL.GL_DRAW_FRAMEBUFFER, renderer._main_fb)
        whole = (0, 0, width, height)
        GL.glBlitFramebuffer(*whole, *whole, GL.GL_COLOR_BUFFER_BIT, GL.GL_LINEAR)
        GL.glBindFramebuffer(GL.GL_READ_FRAMEBUFFER, renderer._main_fb)
        GL.glPixelStorei(GL.GL_PACK_ALIGNMENT, 1)
        pixels = GL.glReadPixels(*whole, GL.GL_RGB, GL.GL_UNSIGNED_BYTE)
        return np.ascontiguousarray(np.frombuffer(pixels, np.uint8).reshape(height, width, 3)[::-1])

    renderer._read_main_framebuffer = read_colour
