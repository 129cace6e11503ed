"""Puts the assets inside the package of a wheel, where `engine.assets` looks for them."""

from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

SHIPPED = ("head", "icons", "models", "takes")  # the pictures of the README stay behind


class AssetsHook(BuildHookInterface[Any]):
    """Adds the folders of `assets/` to the wheel; an editable install reads them from the checkout."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name each folder and its place in the wheel."""
        if version != "editable":
            build_data["force_include"].update({f"assets/{name}": f"engine/_assets/{name}" for name in SHIPPED})
