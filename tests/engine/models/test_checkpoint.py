"""A model file that is damaged, or made to harm, is one sentence and takes no memory."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import torch
from safetensors.torch import save_file

from engine.clean import infer as clean
from engine.clean.network import CleanConfig, CleanNetwork, config_of
from engine.errors import AssetError
from engine.inpaint import expected, infer
from engine.models.checkpoint import MODELS, load_model, rebuilt
from engine.regress import infer as regress

SMALL = CleanNetwork(CleanConfig(hidden=8))


def written(path: Path, config: str, tensors: dict[str, torch.Tensor] | None = None, kind: str = "clean") -> Path:
    held = {name: tensor.contiguous() for name, tensor in SMALL.state_dict().items()} if tensors is None else tensors
    save_file(held, str(path), metadata={"kind": kind, "version": "1", "config": config})
    return path


def test_a_sound_file_gives_its_network(tmp_path: Path) -> None:
    path = written(tmp_path / "a.safetensors", json.dumps(config_of(SMALL)))
    network = clean.load_network(path)
    assert not network.training
    for name, tensor in SMALL.state_dict().items():
        assert torch.equal(tensor, network.state_dict()[name])


def test_the_bundled_networks_are_those_of_their_files() -> None:
    networks = {"inpaint": infer.load().generator, "expected": expected.load(), "clean": clean.load_network()}
    networks |= {f"regress_{name}": network for name, network in regress.load().networks.items()}
    for name, network in networks.items():
        tensors, _ = load_model(MODELS / f"{name}.safetensors", kind=name.partition("_")[0])
        state = network.state_dict()
        assert state and all(torch.equal(state[key], tensors[key]) for key in state)


@pytest.mark.parametrize(
    "config",
    [
        "no JSON",
        "[" * 100_000,
        '{"hidden":' * 50_000,
        "[]",
        "null",
        "{}",
        '{"hidden": "many"}',
        '{"hidden": -1}',
        '{"hidden": 1000000000}',
        '{"hidden": 1' + "0" * 400 + "}",
        '{"hidden": 16}',
        '{"hidden": NaN}',
        '{"hidden": null}',
        '{"unheard_of": 3}',
    ],
    ids=lambda config: config[:24],
)
def test_a_configuration_that_cannot_be_is_a_sentence(tmp_path: Path, config: str) -> None:
    with pytest.raises(AssetError, match=r"a\.safetensors") as caught:
        clean.load_network(written(tmp_path / "a.safetensors", config))
    assert "\n" not in str(caught.value) and len(str(caught.value)) <= 300


@pytest.mark.parametrize("load", [infer.load, expected.load, clean.load_network], ids=["inpaint", "expected", "clean"])
@pytest.mark.parametrize("config", ["{}", '{"members": 4000, "hidden": 4000, "layers": 4000}', "7"])
def test_tensors_of_another_network_are_a_sentence(tmp_path: Path, load, config: str) -> None:
    kind = {infer.load: "inpaint", expected.load: "expected"}.get(load, "clean")
    with pytest.raises(AssetError):
        load(written(tmp_path / "a.safetensors", config, {"a": torch.zeros(3)}, kind))


def test_bytes_that_are_no_tensors_are_a_sentence(tmp_path: Path) -> None:
    whole = written(tmp_path / "whole.safetensors", json.dumps(config_of(SMALL))).read_bytes()
    path = tmp_path / "a.safetensors"
    for content in (b"", b"\xff" * 8, whole[:100], b"\x00" * 64, whole[:8] + b"[" * 4000, whole[8:]):
        path.write_bytes(content)
        with pytest.raises(AssetError):
            clean.load_network(path)


def test_a_network_too_large_for_its_tensors_is_never_allocated(tmp_path: Path) -> None:
    made: list[str] = []

    def build() -> torch.nn.Module:
        layer = torch.nn.Linear(4096, 4096)
        made.append(layer.weight.device.type)
        return layer

    with pytest.raises(AssetError):
        rebuilt(build, {"weight": torch.zeros(1), "bias": torch.zeros(1)}, tmp_path / "a.safetensors", kind="clean")
    assert made == ["meta"]
