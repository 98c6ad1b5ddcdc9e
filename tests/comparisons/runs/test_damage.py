"""The first fault of saved data is told by its key; any other fault by its own words."""

import pytest
from pydantic import TypeAdapter, ValidationError

from comparisons.runs.damage import fault_words, first_fault

FORM = TypeAdapter(dict[str, list[int]])


@pytest.mark.parametrize(
    ("data", "key"), [({"cells": [1, 2, "x"], "more": ["y"]}, "cells.2"), ({"cells": 3}, "cells"), ([], "")]
)
def test_the_first_part_that_is_wrong_has_its_key(data, key):
    with pytest.raises(ValidationError) as caught:
        FORM.validate_python(data)
    found, what = first_fault(caught.value)
    assert found == key
    assert what
    assert fault_words(caught.value) == f"{key}: {what}"


def test_another_fault_has_its_own_words():
    assert fault_words(ValueError("it has no cell")) == "it has no cell"
