from pathlib import Path

import pytest

from engine import assets


@pytest.mark.parametrize(
    "path", [assets.HEAD, assets.DEMO_TAKE, assets.MODELS / "regress_lower.safetensors", assets.ICONS / "check.svg"]
)
def test_what_the_program_opens_is_there(path: Path) -> None:
    assert path.is_file() and path.stat().st_size > 0


def test_an_installed_package_uses_the_assets_inside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assets, "PACKAGE", tmp_path / "engine")
    assert assets._folder() == tmp_path / "assets"
    (tmp_path / "engine" / assets.INSTALLED).mkdir(parents=True)
    assert assets._folder() == tmp_path / "engine" / assets.INSTALLED
