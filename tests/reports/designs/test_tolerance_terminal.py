"""What is printed of a tolerance study: rows by contribution, what a derivative is, the worst case, random designs."""

from analytic.description.crank_motion import RPM
from comparisons.designs.parameters import steady_motion
from comparisons.designs.tolerances import Tolerances, tolerance_request, tolerance_study
from reports.designs.tolerance_terminal import NONE, TIED, document, printout
from reports.document.terminal import rendered
from tests.analytic.linkages import IN_LINE, from_text, mechanism


def printed(sample, results, table, **options):
    """The text of a study."""
    motion = steady_motion(sample, 900.0 * RPM, samples=24)
    study = tolerance_study(tolerance_request(sample, motion, Tolerances(results, None, table), **options))
    found = printout(study)
    return study, rendered(*found.tables, *found.closing)


def test_rows_stand_by_contribution_and_a_mass_moves_no_stroke():
    table = {"rod.mass": 0.01, "rod.B.x": 0.01, "rocker.B.length": {"plus_minus": 0.05, "distribution": "uniform"}}
    study, text = printed(mechanism("rimoldi-164", "as-built"), ("stroke",), table, samples=30)
    rows = [line.split()[0] for line in text.splitlines() if "exact" in line]
    assert rows == ["rocker.B.length", "rod.B.x", "rod.mass"]
    assert "stroke [mm]: 30.9866" in text
    assert "rocker.B.length  0.05  mm uniform" in text
    low, high = study.corners[0] * 1e3
    assert f"{low:.4f} to {high:.4f} mm of all 8 corners" in text
    assert "30 random designs, seed 0: all of them assemble" in text


def test_what_has_no_derivative_says_why():
    table = {"piston.through.y": 0.001, "rod.B.x": 0.001}
    study, text = printed(from_text(IN_LINE), ("v.peak",), table, samples=4)
    assert text.count(TIED) == 1
    first = document(study)["results"]["v.peak"]["tolerances"][0]
    assert first["derivative"] is None
    assert first["contribution"] > 0.0
    _, text = printed(mechanism("parallelogram"), ("Mkr@30",), {"coupler.mass": 0.01}, samples=4)
    assert "difference" in text
    assert NONE not in text.split()
