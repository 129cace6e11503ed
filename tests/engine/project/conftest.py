from __future__ import annotations

import pytest

from engine.project import Contents
from engine.take import Take
from tests.engine.project.projects import sample


@pytest.fixture
def contents(random_take: Take) -> Contents:
    return sample(random_take)
