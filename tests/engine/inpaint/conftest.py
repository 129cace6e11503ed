from __future__ import annotations

from collections.abc import Iterator

import pytest
import torch

from engine.inpaint.statistics import Statistics
from engine.take import Array
from tests.engine.inpaint.gaps import performance, performance_statistics, torn


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    """Networks this small are slower on several threads."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.fixture
def truth() -> Array:
    return performance()


@pytest.fixture
def statistics() -> Statistics:
    return performance_statistics()


@pytest.fixture
def known() -> Array:
    return torn()
