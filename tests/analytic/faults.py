"""A sound linkage file to spoil, and what the program says of it then."""

import pytest

from analytic.description.loading import CATALOGUE, parse
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism

JUKI = (CATALOGUE / "juki-mf7923d.toml").read_text(encoding="utf-8").split("[[published]]")[0]


def message_of(text, variant=None):
    """The one sentence with which a file is refused."""
    with pytest.raises(LinkproofError) as caught:
        Mechanism(parse(text, "sample", "sample.toml", variant))
    message = str(caught.value)
    assert "\n" not in message
    return message
