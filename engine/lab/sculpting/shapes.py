"""The 52 shapes of the ARKit standard as motions of the sculpture."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from engine.lab.modelling.solids import smooth_step, turn_x, turn_y
from engine.lab.sculpting import eyelids, hair, handles
from engine.lab.sculpting.clay import EYE_CENTRE
from engine.lab.sculpting.handles import Handles
from engine.lab.sculpting.motions import Motion, fitted
from engine.lab.sculpting.sculpture import Sculpture
from engine.take import SHAPES, Array

HINGE = np.array([0.0, -1.6, 0.9])
TONGUE_SHARE = 0.92  # of the jaw's motion that the tongue takes part in
GAZE = {"eyeLookUp": turn_x(-24), "eyeLookDown": turn_x(24), "eyeLookIn": turn_y(-28), "eyeLookOut": turn_y(28)}
NEIGHBOURS = 4  # vertices of the skin that a brow hair follows
ONE_SIDED = ("jawLeft", "jawRight", "mouthLeft", "mouthRight")  # the whole mouth to one side


@dataclass(frozen=True, eq=False)
class Modeller:
    """What the shapes are made with: the sculpture, its handles and the fitted motions."""

    head: Sculpture
    handles: Handles
    motions: dict[str, Motion]

    def of(self, name: str) -> Array:
        """Return the motion, (n, 3) in cm, of a shape of the left half or the middle."""
        if name == "tongueOut":
            return tongue_out(self.head)
        if name == "mouthClose":
            return self._mouth_close()
        motion = self.motions[name]
        moved = self.head.still()
        moved[: len(self.head.skin)] = self.handles.motion(motion.moves)
        if name.startswith("jaw"):
            self._open_inside(moved, motion)
        closed = 1.0 if name.startswith("eyeBlink") else 0.0
        raised = (0.0, 0.0) if closed else motion.lids
        moved += move_lids(self.head, closed, *raised) if not name.startswith("jaw") else 0.0
        gaze = GAZE.get(name.removesuffix("Left"))
        if gaze is not None:
            moved += _turned_eye(self.head, gaze)
        return self._with_parts(moved, motion)

    def _open_inside(self, moved: Array, motion: Motion) -> None:
        """Let the inside of the mouth follow the jaw as a rigid body, the more the deeper it lies."""
        head, points = self.head, self.head.skin
        rigid = (points - HINGE) @ turn_x(motion.jaw).T + HINGE + motion.jaw_shift - points
        deep = np.clip((head.ring - 9) / 3.0, 0.0, 1.0)[:, None]
        inside = rigid * head.jaw[:, None]
        moved[: len(points)] = moved[: len(points)] * (1 - deep) + inside * deep

    def _with_parts(self, moved: Array, motion: Motion) -> Array:
        """Add what is no skin: brows follow the skin under them, lower teeth and tongue the jaw."""
        head = self.head
        for part in ("brow_left", "brow_right"):
            moved[head.at[part]] = followed(head, moved, head.points[head.at[part]])
        if motion.jaw or motion.jaw_shift.any():
            turn = turn_x(motion.jaw)
            for part, taking in (("teeth_lower", 1.0), ("tongue", TONGUE_SHARE)):
                points = head.points[head.at[part]]
                moved[head.at[part]] = taking * ((points - HINGE) @ turn.T + HINGE + motion.jaw_shift - points)
        return moved

    def _mouth_close(self) -> Array:
        """Let the lips meet while the jaw stays down.

        On the line where the lips touch it is minus the jaw's motion plus one travel common to both lips, so that lips
        that touch keep touching at every angle of the jaw.
        """
        names, jaw = self.handles.names, self.motions["jawOpen"].moves
        moves = self.motions["mouthClose"].moves.copy()
        at = {name: index for index, name in enumerate(names)}
        for half in (0, len(names)):
            for place in handles.LIP_PLACES[:7]:
                upper, lower = half + at[f"lip 8 {place}"], half + at[f"lip 8 {place if place == 24 else 48 - place}"]
                travel = (moves[upper] + jaw[upper] + moves[lower] + jaw[lower]) / 2
                moves[upper], moves[lower] = travel - jaw[upper], travel - jaw[lower]
        moved = self.head.still()
        moved[: len(self.head.skin)] = self.handles.motion(moves)
        return moved


def shapes(head: Sculpture) -> dict[str, Array]:
    """Return the motion, (n, 3) in cm, of every shape by name; right shapes mirror the left ones."""
    names, motions = fitted()
    placed = handles.of(head)
    assert placed.names == names
    modeller = Modeller(head, placed, motions)
    moved: dict[str, Array] = {}
    for name in SHAPES:
        if name.endswith("Right"):
            continue
        motion = modeller.of(name)
        if name.endswith("Left"):
            moved[name], moved[name.replace("Left", "Right")] = motion, head.flip(motion)
        else:
            moved[name] = head.symmetric(motion)
    return moved


def followed(head: Sculpture, moved: Array, points: Array) -> Array:
    """Return the motion of points that lie on the skin, (n, 3): the mean of the nearest vertices, nearer ones more."""
    skin = len(head.skin)
    away, nearest = cKDTree(head.skin).query(points, k=NEIGHBOURS)
    weight = 1.0 / (np.asarray(away) + 0.05)
    return np.asarray(np.einsum("nk,nkx->nx", weight / np.sum(weight, axis=1, keepdims=True), moved[:skin][nearest]))


def move_lids(head: Sculpture, closed: float = 0.0, raise_upper: float = 0.0, raise_lower: float = 0.0) -> Array:
    """Turn the left lids about the eyeball; the rings towards the socket follow less and less.

    `closed` is 0..1, the raises are degrees.
    """
    motion, loops = head.still(), head.topology.eyes["left"]
    turned = eyelids.rings(closed, raise_upper, raise_lower) - eyelids.rings()
    for ring, offset in enumerate(turned, start=eyelids.SKIN_RINGS):
        motion[loops[ring]] = offset
    for ring, share in ((3, 0.55), (2, 0.25), (1, 0.08)):
        motion[loops[ring]] = share * turned[0]
    pose = (closed, raise_upper, raise_lower)
    motion[head.at["lashes_left"]] = hair.lash_points(*pose) - hair.lash_points()
    return motion


def _turned_eye(head: Sculpture, turn: Array) -> Array:
    motion, part = head.still(), head.at["eye_left"]
    local = head.points[part] - EYE_CENTRE
    motion[part] = local @ turn.T - local
    return motion


def tongue_out(head: Sculpture) -> Array:
    """Put the tongue out between the lips, its tip lowest."""
    motion, part = head.still(), head.at["tongue"]
    eased = smooth_step(5.7, 9.8, head.points[part][:, 2])[:, None]
    motion[part] = eased * [0, 1.0, 3.9] + eased**3 * [0, -1.15, 0]
    return motion
