"""Key figures change with a linkage's file, by a mass of 1e-5; and which recorded rows a request asks for."""

import re
from dataclasses import replace

import pytest

from analytic.description.crank_motion import crank_motion
from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from analytic.kinematics.mechanism import Mechanism
from comparisons.motion.case import Case
from comparisons.trials.campaign.campaign import CampaignRequest
from comparisons.trials.campaign.standard import changes_since, closed_form, key_figures
from comparisons.trials.judging.changes import CLOSED_FORM, COLUMNS, changes, read_rows, write_rows
from comparisons.trials.judging.records import Error
from engines.contract import Setting

LINKAGE = load("juki-mf7923d")
REQUEST = CampaignRequest((LINKAGE,), (crank_motion("run-up"),), "c", ("pymunk",), (Setting.NAIVE, Setting.TUNED))

ERROR = Error("press", "base", "run-up", "1000 rpm", "pymunk", "tuned", "Mkr", limit=1e-4)
FIGURE = Error(*ERROR[:4], CLOSED_FORM, "", "Mkr.peak", outcome="")
FORCE = FIGURE._replace(quantity="joint_force:A.peak")
LARGE = FIGURE._replace(quantity="Mkr.rms")


def changed(before, request=REQUEST, *, every_variant=False):
    now = closed_form(request, every_variant=every_variant)
    return changes_since(before, now, request, every_variant=every_variant)


def _heavier(share: float):
    mass = re.search(r"\bmass *= *([\d.]+)", LINKAGE.text)
    assert mass is not None
    text = LINKAGE.text[: mass.start(1)] + f"{float(mass[1]) * (1.0 + share):.12g}" + LINKAGE.text[mass.end(1) :]
    return parse(text, LINKAGE.name, LINKAGE.name, LINKAGE.variant)


@pytest.mark.parametrize("every_variant", [False, True])
def test_a_mass_changed_by_a_hundred_thousandth_is_seen(every_variant):
    before = closed_form(REQUEST, every_variant=every_variant)
    assert changed(before, every_variant=every_variant) == ()
    found = changed(before, replace(REQUEST, linkages=(_heavier(1e-5),)), every_variant=every_variant)
    assert {"joint_force:O1.peak", "joint_force:A.peak"} & {one.place[-1] for one in found}
    assert all(re.search(r" was \S+ (N|N m|W|kg m²), and is .* %$", one.sentence) for one in found)
    assert {one.place[1] for one in found} == ({"as-built", "as-printed"} if every_variant else {"as-built"})


RECORDED = Error("juki-mf7923d", "as-built", "run-up", "c, gravity on", "pymunk", "tuned", "Mkr", error_max=1e-6)


@pytest.mark.parametrize(
    ("other", "is_asked"),
    [
        ({}, True),
        ({"mechanism": "another"}, True),  # deleted, or renamed
        ({"variant": "as-printed"}, False),
        ({"regime": "run-up-quintic"}, False),
        ({"conditions": "2000 rpm, gravity on"}, False),
        ({"conditions": "c, gravity off"}, True),  # the linkage's
        ({"engine": "mujoco"}, False),
        ({"setting": "best"}, False),
        ({"setting": "naive"}, False),  # decides nothing beside another setting
        ({"engine": CLOSED_FORM, "setting": "", "quantity": "old.peak"}, True),
        ({"engine": CLOSED_FORM, "setting": "", "quantity": "old.peak", "variant": "as-printed"}, False),
    ],
)
def test_what_is_asked_for_and_not_there_any_more_has_vanished(other, is_asked):
    row = RECORDED._replace(**other)
    vanished = [change.place[-1] for change in changed([row]) if change.fails]
    assert vanished == [row.quantity] * is_asked
    narrow = replace(REQUEST, quantities=("Jeq",))
    assert not any(change.fails for change in changed([RECORDED], narrow))


def test_a_regime_of_a_file_is_the_same_whatever_its_conditions_are():
    linkage = load("two-crank-takeup")
    request = CampaignRequest((linkage,), (), "", ("pymunk",), own_regimes=("driven",))
    row = Error(linkage.name, linkage.variant, "driven", "released at 7°", "pymunk", "tuned", "phi", error_max=1e-6)
    vanished = [change.place[-1] for change in changed([row], request) if change.fails]
    assert vanished == ["phi"]


def test_figures_are_the_peaks_of_the_motion():
    found = key_figures(Case(Mechanism(LINKAGE), crank_motion("run-up"), conditions="c"))
    assert {one.quantity: one.error_max for one in closed_form(REQUEST)} == found
    assert found["Peq.peak"] == pytest.approx(found["Mkr.peak"] * 104.72, rel=0.05)  # near full speed
    kinds = {"Mkr", "Peq", "Jeq", "joint_force", "S", "stroke", "v", "a", "transmission_angle", "point", "output"}
    assert {name.partition(":")[0].partition(".")[0] for name in found} == kinds


def error(value, outcome="passed"):
    return ERROR._replace(outcome=outcome, error_max=value)


def figure(value, row=FIGURE, unit="N m"):
    return row._replace(error_max=value, unit=unit)


@pytest.mark.parametrize(
    ("before", "after", "sentence"),
    [
        (error(1e-6), error(2.9e-6), ""),
        (error(1e-6), error(3.1e-6), "the error was 1e-06 of the peak, and is 3.1e-06"),
        (error(1e-6), error(float("nan")), "the error was 1e-06 of the peak, and is nan"),
        (error(1e-15), error(9e-8), ""),  # round-off: below a thousandth of the limit
        (error(1e-15, "computed"), error(1e-3, "computed"), ""),
        (error(1e-6), error(2e-4, "over-limit"), "over-limit, and was not before"),
        (error(1e-6), error(None, "crashed"), "crashed, and was not before"),
        (error(None, "not-provided"), error(2e-4, "over-limit"), "over-limit, and was not before"),
        (error(2e-4, "over-limit"), error(9e-4, "over-limit"), ""),  # it failed before
        (error(2e-4, "over-limit"), error(1e-6), ""),
        (error(1e-6), error(None, "not-provided"), "was recorded, and is not-provided"),
        (error(1e-6), None, "was recorded, and is not there any more"),
        (None, error(1e-6), "was not recorded"),
        (None, error(None, "not-provided"), ""),
        (figure(1.0), figure(1.0 + 9e-7), ""),
        (figure(1.0), figure(1.0 + 2e-6), "was 1 N m, and is 1.000002 N m, +0.0002 %"),
        (figure(0.0), figure(1e-9), "was 0 N m, and is 1e-09 N m"),
        (figure(1.0), None, "was recorded, and is not there any more"),
        (None, figure(1.0), "was not recorded"),
    ],
)
def test_what_has_become_of_a_row(before, after, sentence):
    found = list(changes(filter(None, [before]), filter(None, [after])))
    assert [entry.sentence.partition(": ")[2] for entry in found] == [sentence] * bool(sentence)
    assert [entry.fails for entry in found] == [sentence != "was not recorded"] * bool(sentence)


@pytest.mark.parametrize(("unit", "count"), [("N", 0), ("N m", 1)])
def test_a_figure_that_is_zero_but_for_rounding_has_not_changed(unit, count):
    """Beside a large figure of the same unit it differs between machines by more than a millionth of itself."""
    before = [figure(5.0, LARGE, unit), figure(1e-17, FORCE, "N")]
    after = [figure(5.0, LARGE, unit), figure(3e-16, FORCE, "N")]
    assert len(list(changes(before, after))) == count


def test_a_file_has_the_rows_in_order_with_their_digits(tmp_path):
    rows = [error(1.23456e-5), figure(0.123456789012, FORCE._replace(quantity="force, of A")), figure(1.0)]
    write_rows(rows, tmp_path / "one.csv")
    write_rows(reversed(rows), tmp_path / "two.csv")
    assert (tmp_path / "one.csv").read_bytes() == (tmp_path / "two.csv").read_bytes()
    assert [row.error_max for row in read_rows(tmp_path / "one.csv")] == [1.0, 0.123456789, 1.235e-5]
    assert list(changes(read_rows(tmp_path / "one.csv"), rows)) == []


HEAD, LINE = ",".join(COLUMNS), "m,v,r,c,e,tuned,Mkr,passed,1e-6"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "line 1: expected the columns mechanism,"),
        (f"{LINE}\n{LINE}", "line 1: expected the columns mechanism,"),
        (f"{HEAD}\n{LINE}\nm,v\n", "line 3: expected 9 columns, got 2"),
        (f"{HEAD}\n{LINE}\n{LINE}", "line 3: the same row stands above"),
        (f"{HEAD}\n{LINE}x", "line 2: could not convert string to float: '1e-6x'"),
        (f"{HEAD}\n{LINE.replace('1e-6', 'inf')}", "line 2: expected a finite value, got inf"),
        (f"{HEAD}\n{LINE.replace('passed', 'fine')}", "line 2: expected an outcome, such as passed, got 'fine'"),
        (f"{HEAD}\nm,v,r,c,closed form,,Mkr.peak,,", "line 2: expected a value of the closed form, got none"),
        ("\udcff", "is no text in UTF-8"),
    ],
)
def test_a_file_of_another_form_is_refused_by_its_line(tmp_path, text, words):
    (tmp_path / "held.csv").write_text(text, encoding="utf-8", errors="surrogateescape")
    with pytest.raises(LinkproofError, match=rf"^'.*held\.csv'.* {words}"):
        read_rows(tmp_path / "held.csv")
