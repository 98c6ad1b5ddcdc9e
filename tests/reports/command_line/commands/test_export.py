"""linkproof export: a script of one run, by mechanism or by cell; what cannot be written down is one sentence."""

import pytest

from analytic.errors import LinkproofError, UnknownNameError
from reports.command_line.commands.engines import export
from reports.command_line.requests import CampaignChoice


def _choice(**changed):
    given = {"mechanisms": ("rimoldi-164",), "engines": ("exudyn",), "ramp_time": 0.05, "hold_time": 0.01}
    return CampaignChoice(**given | changed)


def test_a_script_says_what_it_is_and_what_wrote_it(tmp_path, capsys):
    pytest.importorskip("exudyn")
    export(_choice(), None, tmp_path / "case.py")
    text = (tmp_path / "case.py").read_text(encoding="utf-8")
    title = text.split('"""')[1]
    assert title.startswith("rimoldi-164 (as-built), run-up, in exudyn ")
    assert "linkproof export rimoldi-164 --engine exudyn --ramp-time 0.05" in " ".join(title.split())
    compile(text, "case.py", "exec")
    assert not {"linkproof", "analytic", "engines", "comparisons"} & set(text.partition("\nimport")[2].split())
    export(CampaignChoice(), "jump/four-bar/0.1/exudyn/tuned", None)
    assert "linkproof export --cell jump/four-bar/0.1/exudyn/tuned" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(("choice", "cell", "words"), [
    (_choice(settings=("best",)), None, "it is 4 runs extrapolated, and a script holds one: export 'tuned'"),
    (_choice(settings=("all",)), None, "got 1 and 3"),
    (_choice(engines=("direct",)), None, "expected an engine that takes steps, got 'direct'"),
    (_choice(engines=()), None, "expected one --engine"),
    (_choice(), "jump/four-bar/0.1/exudyn/tuned", "not both"),
    (CampaignChoice(), None, "not both"),
    (CampaignChoice(speed=900.0), "jump/four-bar/0.1/exudyn/tuned", "--cell already defines"),
    (CampaignChoice(), "start/positions/0.01/exudyn/tuned", "cannot be exported: the start state violates joint 'A'"),
])  # fmt: skip
def test_what_cannot_be_exported_is_one_sentence(choice, cell, words, tmp_path):
    pytest.importorskip("exudyn")
    with pytest.raises(LinkproofError, match=words):
        export(choice, cell, tmp_path / "case.py")
    assert not list(tmp_path.iterdir())


def test_an_unknown_engine_is_told_with_the_known_ones():
    with pytest.raises(UnknownNameError, match="exudyn"):
        export(_choice(engines=("exudin",)), None, None)
