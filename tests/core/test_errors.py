"""The errors say one sentence and carry what was finished before them."""

from __future__ import annotations

import copy
import pickle

import pytest

from nestedcages_core.errors import FlowError, InvalidMeshError, NestedCagesError, NestingError, ReinflationError

KINDS = (InvalidMeshError, FlowError, ReinflationError, NestingError)


@pytest.mark.parametrize("kind", KINDS)
def test_every_error_is_one_of_ours(kind: type[NestedCagesError]) -> None:
    with pytest.raises(NestedCagesError, match="the loop is open"):
        raise kind("the loop is open")


@pytest.mark.parametrize("kind", [NestedCagesError, *KINDS])
def test_partial_result_is_carried(kind: type[NestedCagesError]) -> None:
    levels = ("first level",)
    assert kind("stuck", partial=levels).partial is levels
    assert kind("stuck").partial is None
    assert str(kind("stuck", partial=levels)) == "stuck"


@pytest.mark.parametrize("kind", [NestedCagesError, *KINDS])
def test_errors_travel_between_processes(kind: type[NestedCagesError]) -> None:
    for copied in (pickle.loads(pickle.dumps(kind("stuck", partial=[1, 2]))), copy.copy(kind("stuck", partial=[1, 2]))):
        assert type(copied) is kind
        assert str(copied) == "stuck"
        assert copied.partial == [1, 2]
