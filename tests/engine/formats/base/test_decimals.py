from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.formats.base.decimals import floats

places = st.integers(0, 17)
numbers = st.one_of(
    st.builds(lambda value, digits: f"{value:.{digits}f}", st.floats(-1e7, 1e7), places),
    st.builds(
        lambda whole, digits: f"{whole}.{digits}", st.integers(-(10**9), 10**9), st.from_regex(r"\A[0-9]{0,18}\Z")
    ),
    st.floats(allow_nan=False).map(repr),
    st.sampled_from(
        ["-0.0", ".5", "-.5", "5.", "00001.50", " 1.5 ", "+2.5", "1e-3", "inf", "1_0.5", "9007199254740993"]
    ),
)


def cells(texts: list[str]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    text = np.frombuffer("".join(f"{each}," for each in texts).encode(), np.uint8)
    ends = np.flatnonzero(text == ord(","))
    return text, np.concatenate([[0], ends[:-1] + 1]), ends


@given(st.lists(numbers, min_size=1, max_size=50))
def test_every_bit_is_as_python_reads_it(texts: list[str]) -> None:
    exact = np.array([float(each) for each in texts])
    np.testing.assert_array_equal(floats(*cells(texts)).view(np.int64), exact.view(np.int64))


@pytest.mark.parametrize("bad", ["", "-", ".", "1.2.3", "--1", "1:2", "0x10", "oops", "１２x", "1.5\x00", "12/4"])
def test_what_is_no_number_is_named(bad: str) -> None:
    with pytest.raises(ValueError) as caught:
        floats(*cells(["1.0", bad, "worse"]))
    assert caught.value.args == (1,)


def test_any_four_bytes_are_judged_as_python_judges_them() -> None:
    rng = np.random.default_rng(0)
    alphabet = np.frombuffer(b"0123456789.-+e /:\xff", np.uint8)
    for text in rng.choice(alphabet, (3000, 4)):
        try:
            exact = float(text.tobytes())
        except ValueError:
            with pytest.raises(ValueError):
                floats(text, np.array([0]), np.array([4]))
        else:
            assert floats(text, np.array([0]), np.array([4])).tobytes() == np.float64(exact).tobytes()
