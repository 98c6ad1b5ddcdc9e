"""Every quantity has a limit with a reason in every setting and regime."""

import itertools
import json

import pytest

from analytic.description.crank_motion import REGIMES
from analytic.errors import LinkproofError
from comparisons.judging.limits import USERS, limit, read_limits, table_of
from comparisons.judging.quantities import QUANTITIES
from comparisons.stress.verdict import ALARMS as INVARIANTS
from engines.contract import Setting

GIVEN = {"Mkr", "Peq"}  # by the drive of a released crank, not results


def test_the_table_is_complete():
    for quantity in (*QUANTITIES, *INVARIANTS, "joint_force:A"):
        for setting, regime in itertools.product(Setting, [*REGIMES, "a-regime-of-its-own"]):
            if quantity in GIVEN and regime not in REGIMES:
                continue
            row = limit(quantity, setting, regime)
            least_strict = 0.06 if setting is Setting.NAIVE else 0.02  # no looser than what the sources claim
            assert 0.0 < row.value <= least_strict, (quantity, setting, regime)
            assert len(row.reason.split()) > 4, (quantity, setting, regime)


def test_best_is_held_to_more_than_tuned():
    assert limit("Mkr", "best", "run-up-quintic").value < limit("Mkr", "tuned", "run-up-quintic").value


def test_an_uncovered_quantity_says_what_to_add():
    with pytest.raises(LookupError, match="add one with its reason"):
        limit("colour", "tuned", "run-up")


def test_rows_of_a_user_go_before_the_table(tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text('[[limit]]\nquantities = ["Mkr"]\nmechanisms = ["press"]\nregimes = ["own"]\nvalue = 0.5\n')
    table = read_limits(path)
    own = table.limit("Mkr", "tuned", "a-regime-of-its-own", "press")
    assert (own.value, own.reason) == (0.5, USERS)
    for quantity, regime, mechanism in ("Jeq", "free", "press"), ("Mkr", "run-up", "press"), ("Mkr", "free", "other"):
        assert table.limit(quantity, "tuned", regime, mechanism) == limit(quantity, "tuned", regime)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("[[limit", "expected a TOML file of limits"),
        ("", "expected tables [[limit]]"),
        ("limit = 3", "expected tables [[limit]]"),
        ("limits = 3", "got the key 'limits'"),
        ("limit = [3]", "limit 1: expected a table"),
        ("[[limit]]\nvalue = 1e-3", "limit 1: quantities: expected what it is for"),
        ('[[limit]]\nquantities = ["Mkr"]', "limit 1: value: expected a positive share"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = nan', "limit 1: value"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = true', "limit 1: value"),
        ('[[limit]]\nquantities = "Mkr"\nvalue = 1', "limit 1: quantities: expected a list of names"),
        (
            '[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nsettings = ["tune"]',
            "unknown setting of .* limit 1 'tune': .*tuned",
        ),
        ('[[limit]]\nquantities = ["Mrk"]\nvalue = 1', "unknown quantity of .* limit 1 'Mrk': .*Mkr"),
        ('[[limit]]\nquantities = ["Mkr"]\nvalue = 1\nreasons = ""', "unknown key of .* limit 1 'reasons'"),
    ],
)
def test_a_wrong_table_is_said_in_one_sentence(tmp_path, text, words):
    (tmp_path / "limits.toml").write_text(text)
    with pytest.raises(LinkproofError, match=words.replace("[[limit]]", r"\[\[limit\]\]")):
        read_limits(tmp_path / "limits.toml")


def test_a_table_comes_back_from_its_data(tmp_path):
    path = tmp_path / "limits.toml"
    path.write_text('[[limit]]\nquantities = ["Mkr", "Peq"]\nsettings = ["best"]\nvalue = 1e-3\nreason = "mine"\n')
    table = read_limits(path)
    assert table_of(json.loads(json.dumps(table.as_dict))) == table


def test_a_file_that_cannot_be_read_is_said_in_one_sentence(tmp_path):
    for path in (tmp_path, tmp_path / "none.toml"):
        with pytest.raises(
            LinkproofError, match=r"expected a TOML file of limits at '.*', got '[A-Z][a-z ]+'; check it$"
        ):
            read_limits(path)
