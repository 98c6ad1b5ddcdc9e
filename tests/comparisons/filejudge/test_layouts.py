"""Every layout read back: what was written comes out, as sharp as it was printed; and no bytes end in a traceback."""

import re
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic.description.loading import load
from analytic.errors import LinkproofError
from comparisons.filejudge import tables
from comparisons.filejudge.reading import read_results
from comparisons.filejudge.tables import result_tables
from tests.comparisons.filejudge import layouts
from tests.comparisons.filejudge.layouts import Channel

JUKI = load("juki-mf7923d")
NUMBERS = st.floats(-1e6, 1e6, allow_nan=False).filter(lambda x: x == 0.0 or abs(x) > 1e-6)
ENCODINGS = ("utf-8", "utf-8-sig", "utf-16", "cp1252")  # the last of which has to be named


def _file(tmp_path, name, text):
    path = tmp_path / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@st.composite
def curves(draw):
    values = np.array(draw(st.lists(NUMBERS, min_size=4, max_size=12)))
    return np.arange(len(values)) * 0.5, values


@settings(max_examples=30)
@given(
    curve=curves(),
    signs=st.sampled_from([",.", ";.", ";,", "\t.", "\t,", " .", " ,"]),
    digits=st.integers(3, 15),
    looks=st.fixed_dictionaries({"quotes": st.booleans(), "trailing": st.booleans(), "unit_row": st.booleans()}),
    title=st.sampled_from(["", "Run 3", "# exported, with a comma; and more"]),
    coded=st.tuples(st.sampled_from(ENCODINGS), st.sampled_from(["\n", "\r\n", "\r"])),
)
def test_a_csv_comes_back_to_half_a_unit_of_its_last_digit(  # noqa: PLR0917
    tmp_path_factory, curve, signs, digits, looks, title, coded
):
    time, values = curve
    delimiter, decimal = signs
    if delimiter == " ":
        looks = {"quotes": True}
    channels = [Channel("t", "s", time), Channel("x", "°", values)]
    text = layouts.csv(channels, delimiter=delimiter, decimal=decimal, digits=digits, title=title, **looks)
    path = tmp_path_factory.mktemp("csv") / "run.csv"
    path.write_bytes(text.replace("\n", coded[1]).encode(coded[0]))
    (table,) = result_tables(path, "cp1252" if coded[0] == "cp1252" else "")
    assert [column.header.split(" ")[0] for column in table.columns] == ["t", "x"]
    read = table.columns[1]
    printed = np.array([float(f"{x:.{digits}g}") for x in values])
    np.testing.assert_array_equal(read.values, printed)
    assert np.all(np.abs(read.values - values) <= read.resolution * (1.0 + 1e-9) + 1e-16 * np.abs(values))


def test_fixed_decimals_and_scientific_numbers_are_half_a_unit_of_their_last_digit_sharp(tmp_path):
    channels = [Channel("t", "s", np.arange(5)), Channel("x", "m", np.array([0.0, 0.5, -123.456, 7.0, 1e4]))]
    path = _file(tmp_path, "fixed.csv", layouts.csv(channels, decimals=2))
    np.testing.assert_allclose(result_tables(path)[0].columns[1].resolution, 0.005)
    path = _file(tmp_path, "run.csv", "t;x\n0;1.25e-3\n1;1.25E+3\n2;0.00e0\n3;-2.50D-1\n")
    read = result_tables(path)[0].columns[1]
    np.testing.assert_array_equal(read.values, [1.25e-3, 1.25e3, 0.0, -0.25])
    np.testing.assert_allclose(read.resolution, [5e-6, 5.0, 5e-6, 5e-4])


def _columns(*columns):
    return [Channel(*column) for column in columns]


TIME = np.linspace(0.0, 1.0, 11)
COS = np.cos(TIME)
MODELICA = _columns(("time", "", TIME), ("crank.phi", "", TIME**2), ("motor.tau", "", COS))
ADAMS = _columns(("time", "sec", TIME), ("JOINT_A.FX", "newton", TIME**2), ("MOTION_1.TZ", "newton-millimeter", COS),
                 ("JOINT_7.FX", "newton", TIME))  # fmt: skip
TAB = _columns(("Time", "", TIME), ("MOTION_1_TZ", "", COS), ("", "", TIME), ("crank.WZ", "", TIME**2))
NO_TIME = "expected a unit of time in the header '{}', got none"
# By layout: the file, what is said of it and the reason why that is needed, its columns, and how sharp they are.
LAYOUTS = {
    "run.xlsx": (lambda: layouts.workbook(_columns(("Zeit", "s", TIME), ("Antriebsmoment", "N*m", COS))), (), "",
                 ["Zeit [s]", "Antriebsmoment [N*m]"], 0.0),
    "columns.mat": (lambda: layouts.trajectory(MODELICA, transposed=True), (), "",
                    ["time", "crank.phi", "motor.tau"], 1e-15),
    "rows.mat": (lambda: layouts.trajectory(MODELICA, transposed=False, kind=np.float32), (), "",
                 ["time", "crank.phi", "motor.tau"], 1e-6),
    "arrays.mat": (lambda: layouts.matlab(t=TIME, Mkr=COS[:, None], D=np.zeros((11, 2)), n=3.0),
                   ("t=time [s]", "Mkr=Mkr [N*m]"), NO_TIME.format("t"), ["t", "Mkr", "D(1)", "D(2)"], 0.0),
    "run.res": (lambda: layouts.adams_results(ADAMS), (), "",
                ["TIME", "JOINT_A.FX", "MOTION_1.TZ", "JOINT_7.FX"], 1e-15),
    "run.tab": (lambda: layouts.adams_table(TAB), ("Time=time [s]", "MOTION_1_TZ=Mkr [N*m]", "crank.WZ="),
                NO_TIME.format("Time"), ["Time", "MOTION_1_TZ", "crank.WZ"], 1.01e-4),
    "qq.res": (lambda: layouts.robotran([Channel("", "", TIME), Channel("", "", COS)]),
               ("column 1=time [s]", "column 2=Mkr [N*m]"), "'column 1' is not judged", ["", ""], 1e-9),
}  # fmt: skip


@pytest.mark.parametrize("name", LAYOUTS)
def test_a_layout_of_a_tool_comes_back_as_sharp_as_it_is_written(tmp_path, name):
    if name == "run.xlsx":
        pytest.importorskip("openpyxl")
    write, said, reason, headers, sharp = LAYOUTS[name]
    path = _file(tmp_path, name, write())
    (table,) = result_tables(path)
    assert [column.header for column in table.columns] == headers
    if said:
        with pytest.raises(LinkproofError, match=re.escape(reason)):
            read_results([path], JUKI)
    torque = next(signal for signal in read_results([path], JUKI, said).signals if signal.name == "Mkr")
    assert torque.column.place.startswith(f"{path}[curves]:1 (" if name == "run.xlsx" else str(path))
    true = COS * (1e-3 if name == "run.res" else 1.0)
    np.testing.assert_allclose(torque.values, true, rtol=sharp)
    assert np.all(np.abs(torque.values - true) <= torque.rounding + 1e-16)
    assert np.max(torque.rounding) <= 1.01e-4


def test_a_damaged_matlab_file_is_refused_whatever_its_reader_does(tmp_path):
    content = bytearray(layouts.matlab(t=np.arange(9.0), Mkr=np.arange(9.0)))
    content[140:148] = b"\xff" * 8
    with pytest.raises(LinkproofError, match=r"run.mat: expected"):
        read_results([_file(tmp_path, "run.mat", bytes(content))], JUKI)


def test_what_unpacks_to_more_than_can_be_read_is_refused_before_it_is_read(tmp_path):
    book = tmp_path / "bomb.xlsx"
    with zipfile.ZipFile(book, "w", zipfile.ZIP_DEFLATED) as parts:
        parts.writestr("xl/sharedStrings.xml", b"x" * (tables.LARGEST + 1))
    with pytest.raises(LinkproofError, match="it is packed, and has 128 MB"):
        result_tables(book)
    with pytest.raises(LinkproofError, match=r"cannot be read \(needed more than 1 GiB of memory\)"):
        tables._read_isolated(_hungry, book)


def _hungry(_):
    return bytearray(2 << 30)


def test_numbers_too_small_to_square_are_zero(tmp_path):
    path = _file(tmp_path, "run.csv", "t [s],x [m]\n0,1e-320\n1,-5e-101\n2,1e-99\n3,1\n")
    assert result_tables(path)[0].columns[1].values.tolist() == [0.0, 0.0, 1e-99, 1.0]


def test_tables_one_below_another_have_their_own_axes(tmp_path):
    text = "# t [s], x [m]\n0,1\n1,2\n2,3\n3,4\nt [s],y [m],,z [m]\n0,1,,2\n1,2,,3\n"
    first, second = result_tables(_file(tmp_path, "run.csv", text))
    assert (first.line, second.line) == (1, 6)
    assert first.columns[1].values.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert [column.header for column in second.columns] == ["t [s]", "y [m]", "z [m]"]
    assert second.columns[2].values.tolist() == [2.0, 3.0]


def test_a_fault_far_down_a_long_file_is_told_by_its_line(tmp_path):
    rows = "0.0001;-12.3456;1.25e-3\n" * 20_000
    text = "t;x;y\n" + rows + "not a number;1;2\n" * 2_000
    with pytest.raises(LinkproofError, match=r"run.csv:20002: expected a finite number in column 1"):
        result_tables(_file(tmp_path, "run.csv", text))
