"""FMUs are run and judged like files: a slider-crank in C, right, with a fault planted, and all that cannot be run."""

import platform
import re
import shutil
import subprocess
import zipfile
from pathlib import Path

import numpy as np
import pytest

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.imported import binary_files
from comparisons.imported.judge import judge
from comparisons.imported.reading import read_results
from comparisons.imported.result_files import result_tables

HERE = Path(__file__).parent
MODEL = load(str(HERE / "foreign" / "slider-crank.toml"))
UNITS = {"crank.phi": "rad", "rod.w": "rad/s", "motor.tau": "N.m", "C.x": "mm"}
EXPERIMENT = '<DefaultExperiment stopTime="0.3" stepSize="0.001"/>'
INPUT = '<ScalarVariable name="load" valueReference="9" causality="input"><Real start="0"/></ScalarVariable>'


@pytest.fixture(scope="module")
def binary(tmp_path_factory):
    """What makes a binary of the model; the functions of FMI that it does not need do nothing."""
    fmpy, folder = pytest.importorskip("fmpy"), tmp_path_factory.mktemp("binaries")
    if shutil.which("gcc") is None or (platform.system(), platform.machine()) != ("Linux", "x86_64"):
        pytest.skip("the FMUs are made by gcc for Linux")
    source = (HERE / "slider_crank.c").read_text()
    every = [name for kind in (fmpy.fmi2.FMU2Slave, fmpy.fmi2.FMU2Model, fmpy.fmi3.FMU3Slave) for name in dir(kind)]
    empty = [name for name in every if re.match(r"fmi\d[A-Z]", name) and not re.search(rf"\b{name}\(", source)]
    source += "".join(f"int {name}(void) {{ return 0; }}\n" for name in dict.fromkeys(empty))

    def make(piston, do):
        file = folder / f"{piston}{abs(hash(do))}.so"
        flags = ["-w", "-shared", "-fPIC", f"-DPISTON={piston}", f"-DDO={do}"]
        if not file.exists():
            subprocess.run(["gcc", *flags, "-x", "c", "-", "-lm", "-o", file], input=source, text=True, check=True)
        return file

    return make


@pytest.fixture
def fmu(tmp_path, binary):
    """What makes an FMU with outputs in these units."""

    def make(*, version="2.0", way="CoSimulation", units=UNITS, piston=0.6, do="", more=""):
        kind = {"2.0": "<ScalarVariable {}><Real {}/></ScalarVariable>", "3.0": "<Float64 {} {}>{}</Float64>"}[version]
        variables = [
            kind.format(
                f'name="{name}" valueReference="{n}" causality="output" variability="continuous"',
                unit and f'unit="{unit}"',
                '<Dimension start="2"/>' if name == "C" else "",
            )
            for n, (name, unit) in enumerate(units.items())
        ]
        path = tmp_path / "run.fmu"
        place = {"2.0": "linux64", "3.0": "x86_64-linux"}[version]
        with zipfile.ZipFile(path, "w") as parts:
            parts.write(binary(piston, do), f"binaries/{place}/model.so")
            parts.writestr(
                "modelDescription.xml",
                f'<fmiModelDescription fmiVersion="{version}" modelName="model" guid="1" instantiationToken="1">'
                f'<{way} modelIdentifier="model"/>{EXPERIMENT}<ModelVariables>{"".join(variables)}{more}'
                "</ModelVariables><ModelStructure/></fmiModelDescription>",
            )
        return path

    return make


@pytest.mark.parametrize("way", ["CoSimulation", "ModelExchange"])
def test_an_fmu_is_judged_as_a_file_is(fmu, way):
    judgement = judge(MODEL, read_results([fmu(way=way, piston=0.66)], MODEL))
    assert judgement.motion_source == "column 'crank.phi'"
    assert {"link:rod:omega", "Mkr"} <= {one.name for one in judgement.verdicts}
    (finding,) = judgement.explanation.findings
    assert finding.likeliest.words == "the mass of 'piston' is 0.66 kg in place of 0.6 kg"


def test_an_array_of_fmi_3_is_a_column_for_each_of_its_numbers(fmu):
    (table,) = result_tables(fmu(units={**UNITS, "C": "mm"}, version="3.0"))
    assert [column.header for column in table.columns] == ["time", *UNITS, "C[1]", "C[2]"]
    assert [column.unit for column in table.columns] == ["s", *UNITS.values(), "mm", "mm"]
    np.testing.assert_array_equal(table.columns[-1].values, 12.0)


REFUSED = {
    "an input": ({"more": INPUT}, r"\(its input 'load' has no value; let the model itself drive it"),
    "a crash": ({"do": "abort()"}, r"\(it crashes\)"),
    "an endless step": ({"do": "for (;;)"}, r"\(it takes more than 1 s\)"),
    "not a number": ({"do": "now = sqrt(-1.0)"}, "expected finite numbers of 'crank.phi'"),
    "one unit of none": (
        {"units": {**UNITS, "motor.tau": ""}}, "expected a unit of Mkr in the header 'motor.tau', got none"
    )
}  # fmt: skip


@pytest.mark.parametrize(("changes", "words"), REFUSED.values(), ids=REFUSED)
def test_an_fmu_that_cannot_be_run_is_refused_in_a_sentence(fmu, monkeypatch, changes, words):
    monkeypatch.setattr(binary_files, "LONGEST_RUN", 1.0 if "for" in changes.get("do", "") else 60.0)
    with pytest.raises(LinkproofError, match=words) as caught:
        read_results([fmu(**changes)], MODEL)
    assert "\n" not in str(caught.value)


def test_without_fmpy_an_fmu_is_refused_with_what_installs_it(tmp_path, monkeypatch):
    monkeypatch.setattr(binary_files, "find_spec", lambda name: None)
    path = tmp_path / "run.fmu"
    path.touch()
    with pytest.raises(LinkproofError, match=r"got none installed; pip install 'linkproof\[fmi\]'"):
        read_results([path], MODEL)


def test_a_damaged_fmu_is_refused_in_a_sentence(fmu):
    path = fmu()
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(LinkproofError, match="an FMU that cannot be read"):
        read_results([path], MODEL)
