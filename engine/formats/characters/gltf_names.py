"""What a glTF file calls its morph targets: the format has no place for it, and each program found its own."""

from __future__ import annotations

from typing import Any

from engine.formats.characters.accessors import Accessors, Structure

LONGEST = 200  # letters of a name that are kept
NAME_KEYS = ("name", "targetName")


def target_names(mesh: Structure, primitive: Structure, accessors: Accessors) -> list[str]:
    """Return a name for each morph target of a primitive, each once.

    Looked for in turn, target by target: the mesh's extras (Blender, Unity, VRM 1), the primitive's extras (VRM 0), the
    target's own extras, and the name of the accessor that holds it; the target's number where there is none.
    """
    targets = primitive.get("targets") or []
    lists = [_listed(mesh), _listed(primitive)]
    names: list[str] = []
    for number, target in enumerate(targets):
        found = [listed[number] for listed in lists if number < len(listed)]
        found += [_own(target), accessors.name(target["POSITION"]) if target.get("POSITION") is not None else ""]
        names.append(next((str(name)[:LONGEST] for name in found if _is_name(name)), f"target {number}"))
    return _each_once(names)


def _listed(owner: Structure) -> list[Any]:
    extras = owner.get("extras")
    names = extras.get("targetNames") if isinstance(extras, dict) else None
    return names if isinstance(names, list) else []


def _own(target: Structure) -> Any:
    extras = target.get("extras")
    if isinstance(extras, dict):
        return next((extras[key] for key in NAME_KEYS if _is_name(extras.get(key))), "")
    return extras


def _is_name(name: Any) -> bool:
    return isinstance(name, str) and bool(name.strip())


def _each_once(names: list[str]) -> list[str]:
    """Return the names with a number behind those that were there before."""
    seen: dict[str, int] = {}
    result = []
    for name in names:
        seen[name] = seen.get(name, 0) + 1
        result.append(name if seen[name] == 1 else f"{name} #{seen[name]}")
    return result
