"""linkproof export: a script of one run, by mechanism or by cell; what cannot be written down is one sentence."""

import ast

import pytest

from analytic.errors import LinkproofError, UnknownNameError
from reports.command_line.commands.engines import export
from reports.requests.options.campaign import ExportOptions

CELL = "jump/four-bar/0.1/exudyn/tuned"


def _choice(**changed):
    given = {"mechanism": "rimoldi-164", "engine": "exudyn", "ramp_time": 0.05, "hold_time": 0.01}
    return ExportOptions(**given | changed)


def test_a_script_says_what_it_is_and_what_wrote_it(tmp_path, capsys):
    pytest.importorskip("exudyn")
    export(_choice(), tmp_path / "case.py")
    text = (tmp_path / "case.py").read_text(encoding="utf-8")
    title = ast.get_docstring(ast.parse(text))
    assert title.startswith("rimoldi-164 (as-built), run-up, in exudyn ")
    assert "linkproof export rimoldi-164 --ramp-time 0.05 --hold-time 0.01 --engine exudyn" in " ".join(title.split())
    compile(text, "case.py", "exec")
    assert not {"linkproof", "analytic", "engines", "comparisons"} & set(text.partition("\nimport")[2].split())
    export(ExportOptions(cell=CELL), None)
    assert f"linkproof export --cell {CELL}" in ast.get_docstring(ast.parse(capsys.readouterr().out))


@pytest.mark.parametrize(("options", "words"), [
    (_choice(setting="best"), "it is 4 runs extrapolated, and a script holds one: export 'tuned'"),
    (_choice(setting="all"), "got 1 and 3"),
    (_choice(engine="direct"), "whose loop is a module of its own \\(a LoopEngine\\), got 'direct': export another"),
    (_choice(engine=None), "expected one --engine"),
    (_choice(cell=CELL), "not both"),
    (ExportOptions(), "not both"),
    (ExportOptions(speed=900.0, cell=CELL), "--cell already defines"),
    (
        ExportOptions(cell="start/positions/0.01/exudyn/tuned"),
        "cannot be exported: the start state violates joint 'A'",
    ),
])  # fmt: skip
def test_what_cannot_be_exported_is_one_sentence(options, words, tmp_path):
    pytest.importorskip("exudyn")
    with pytest.raises(LinkproofError, match=words):
        export(options, tmp_path / "case.py")
    assert not list(tmp_path.iterdir())


def test_an_unknown_engine_is_told_with_the_known_ones():
    with pytest.raises(UnknownNameError, match="exudyn"):
        export(_choice(engine="exudin"), None)
