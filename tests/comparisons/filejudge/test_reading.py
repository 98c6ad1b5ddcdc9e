"""Result files read as signals of a linkage: what is taken, what is asked for, what is refused, with which cure."""

import math
import os
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from comparisons.filejudge.columns import Column, Correction
from comparisons.filejudge.headers import HeaderParser, NotJudgedError, parse_unit
from comparisons.filejudge.reading import map_entries, read_results
from tests.analytic.linkages import driven
from tests.comparisons.filejudge.layouts import Channel, results_of, solidworks

READ = HeaderParser(load("juki-mf7923d"))

MEANT = {
    "time": ("Time (sec)", "t/s", "time_s", "Zeit in s", "время, с", "Час (с)", "simTime (ms)"),
    "Mkr": ("Motor Torque12 (newton-meter)", "Torque", "torque_Nm", "M (Nm)", "Antriebsmoment [Nm]",
            "Motordrehmoment (N·m)", "крутящий момент, Н·м", "Крутний момент (Н·м)",
            "motor.tau", "MOTION_1.TZ", "DriveTorque [in-lb]", "Torque RotaryMotor1 (N*mm)"),
    "phi": ("Angular Displacement1 (deg)", "Kurbelwinkel [°]", "φ/°", "crank.phi", "Angle (rad)",
            "кут кривошипа (град)"),
    "omega": ("Angular Velocity1 (deg/sec)", "Motor Speed (rpm)", "Drehzahl [1/min]", "crank.w",
              "Kurbelwinkelgeschwindigkeit (rad/s)", "угловая скорость кривошипа, рад/с"),
    "epsilon": ("Angular Acceleration3 (deg/sec**2)", "α (rad/s²)", "angular_accel_rad/s2"),
    "Peq": ("Power Consumption1 (watt)", "Motorleistung [W]", "потужність двигуна, Вт"),
    "Teq": ("Kinetic Energy (J)", "Кинетическая энергия, Дж", "Ekin [mJ]"),
    "Jeq": ("Jeq (kg m^2)", "Reduced inertia (kg·mm²)"),
    "S": ("S (mm)", "Linear Displacement2 (mm)", "Weg [mm]", "Kolbenweg [mm]", "Slider displacement (mm)"),
    "v": ("Linear Velocity1 (mm/sec)", "скорость ползуна (м/с)", "Speed (mm/s)"),
    "a": ("Linear Acceleration (mm/sec**2)", "Beschleunigung [m/s²]"),
    "point:D:x": ("D.x", "x_D (mm)", "coupler.D.x (m)", "Position D X [in]", "point:D:x"),
    "point:D:vy": ("D.vy (m/s)", "Velocity D Y (mm/s)", "D.y [m/s]"),
    "link:coupler:angle": ("coupler.phi", "Angle coupler (deg)", "link:coupler:angle"),
    "link:coupler:omega": ("Angular Velocity coupler (rad/s)", "coupler.WZ (deg/sec)"),
    "joint_force:A:x": ("Reaction Force A X (newton)", "JOINT_A.FX", "A.x [N]", "сила реакции A x (Н)"),
    "joint_force:A:magnitude": ("Reaction Force A (N)", "Gelenkkraft A Betrag [N]"),
    "joint_force:needle_bar on ground:x": ("needle_bar on ground FX (N)", "joint_force:needle_bar on ground:x [N]"),
    "shaking_force:x": ("Shaking Force X (N)",)
}  # fmt: skip
OPEN = {
    "Reaction Force1 (newton)": "its name fits none of joint_force:A, joint_force:D, joint_force:O1",
    "Trace Path1 (mm)": "its name fits none of S, point:A, point:D",
    "Torque (mm)": "'mm' is no unit of Mkr",
    "foo": "'foo' in its name",
    "Speed": "it may be omega, v: add its unit",
    "Spring force (N)": "no such quantity",
    "Motor Torque X (Nm)": "its name fits none of Mkr",
    "D (mm)": "its name fits none of S, point:A",
    "Torque coupler (Nm)": "its name fits none of Mkr",
    "A D x (mm)": "its name fits none of S, point:A",
    "Torque [furlong]": "'furlong' in its name is no unit",
}

JUKI = load("juki-mf7923d")
TIME = np.linspace(0.0, 1.0, 6)
ROWS = "0,1.5\n0.1,2.25\n0.2,3\n0.3,4\n"


def _column(header, values=(1.0, 2.0, 3.0, 4.0)):
    values = np.array(values)
    return Column(header, "", values, 0.0 * values, "run.csv:1 (column 2)")


def test_headers_mean_what_an_engineer_reads_in_them():
    read = {}
    for headers in MEANT.values():
        for header in headers:
            try:
                read[header] = READ.meaning(_column(header)).signal
            except LinkproofError as reason:
                read[header] = str(reason)
    expected = {header: signal for signal, headers in MEANT.items() for header in headers}
    assert {header: read[header] for header in expected if read[header] != expected[header]} == {}


def _reason(header, *values):
    with pytest.raises(NotJudgedError) as caught:
        READ.meaning(_column(header, *values))
    return str(caught.value)


@pytest.mark.parametrize(("header", "reason"), OPEN.items())
def test_what_may_be_two_things_or_none_is_left_open_with_the_reason(header, reason):
    assert reason in _reason(header)


def test_a_force_that_changes_its_sign_and_endless_headers_are_left_open():
    assert "changes its sign" in _reason("Reaction Force A (N)", (1.0, -1.0))
    assert "is longer than" in _reason("(" * 100_000)
    assert "is longer than" in _reason("moment" * 20_000)


def test_what_is_taken_is_said():
    taken = {
        "Torque [Nm]": "its name has no link: taken as the crank's",
        "Angle (deg)": "its name has no link: taken as the crank's",
        "Motor Torque (Nm)": "",
        "Weg [mm]": "taken as the output's, D along [0, 1]",
        "Reaction Force A (N)": "its name has no component: taken as the size of the force",
    }
    assert {header: READ.meaning(_column(header)).assumption for header in taken} == taken


def test_names_of_one_letter_or_of_digits_do_not_stand_in_the_way():
    text = """
        title = "Four-bar with names of one letter and of digits"
        units = { length = "m", mass = "kg", inertia = "kg*m^2", angle = "deg" }
        crank = "1"
        ground = { O = [0, 0], C = [0.3, 0] }
        links.1 = { points = { O = [0, 0], M = [0.08, 0] }, mass = 1, inertia = 0.01 }
        links.2 = { points = { M = [0, 0], P = [0.25, 0] }, mass = 1, inertia = 0.01 }
        links.3 = { points = { C = [0, 0], P = [0.2, 0] }, mass = 1, inertia = 0.01 }
        sketch = { angle = 90, points = { P = [0.25, 0.2] } }
    """
    read = HeaderParser(parse(text, "letters", "letters.toml"))
    expected = {"M [Nm]": "Mkr", "P [W]": "Peq", "P.x [m]": "point:P:x", "Angular Velocity2 (rad/s)": "omega"}
    assert {header: read.meaning(_column(header)).signal for header in expected} == expected


@given(
    st.lists(
        st.sampled_from([*"([{<)]}>/_,:;.#²°φ 12", "in", "Nm", "Torque", "A", "D", "x", "Winkel", "force", "\u202e"])
    )
)
def test_no_header_ends_in_a_traceback(parts):
    try:
        meaning = READ.meaning(_column("".join(parts)))
    except LinkproofError:
        return
    assert meaning.signal in ("time", *READ.signals)


def test_a_cylinder_has_a_length_a_speed_and_a_force():
    read = HeaderParser(driven("cylinder-in-the-loop").linkage)
    meant = {
        "phi": ("Cylinder length [mm]", "Zylinderlänge (mm)", "Zylinderweg [mm]",
                "Довжина циліндра, мм"),
        "omega": ("Cylinder speed (mm/s)", "Actuator velocity [m/s]"),
        "Mkr": ("Cylinder force [N]", "Zylinderkraft [kN]", "Усилие гидроцилиндра, Н", "Hydraulikkraft (N)")
    }  # fmt: skip
    for signal, headers in meant.items():
        assert {read.meaning(_column(header)).signal for header in headers} == {signal}
    for any_drive in (read, READ):
        with pytest.raises(NotJudgedError):
            any_drive.meaning(_column("Length [mm]"))


DEGREE = math.pi / 180.0


def test_units_have_their_si_values():
    expected = {
        "newton-meter": 1.0, "N·m": 1.0, "N.m": 1.0, "Nm": 1.0, "N m": 1.0, "Н·м": 1.0, "NEWTON-METER": 1.0,
        "牛米": 1.0, "N-mm": 1e-3, "Ncm": 1e-2, "kN·m": 1e3, "in-lb": 4.4482216152605 * 0.0254, "lbf": 4.4482216152605,
        "°": DEGREE, "град": DEGREE, "rad": 1.0, "rev": 2.0 * math.pi, "deg/sec": DEGREE, "s^-1": 1.0, "1/s": 1.0,
        "rpm": math.pi / 30.0, "U/min": math.pi / 30.0, "об/мин": math.pi / 30.0, "deg/sec**2": DEGREE,
        "rad/s²": 1.0, "rad/s2": 1.0, "rad s^-2": 1.0, "m/(s^2)": 1.0, "inch/sec**2": 0.0254, "µm": 1e-6,
        "ms": 1e-3, "min": 60.0, "kW": 1e3, "N*mm/s": 1e-3, "Дж": 1.0, "kg·mm²": 1e-6, "kgf": 9.80665, "-": 1.0
    }  # fmt: skip
    read = {text: unit.factor if (unit := parse_unit(text)) else None for text in expected}
    assert read == pytest.approx(expected, rel=1e-14)


def test_what_is_no_unit_is_none():
    for text in ("furlong", "", "1", "m/s/s", "N*", "/", "Motor1", "N^9", "x" * 99, "m^", "**2", "(", "²"):
        assert parse_unit(text) is None, text


def test_a_speed_of_rotation_may_be_in_one_over_seconds_and_nothing_else_may_lose_its_angle():
    per_second, metre_per_second = parse_unit("1/s"), parse_unit("m/s")
    assert per_second.measures((0, 0, -1, 1))
    assert not metre_per_second.measures((0, 0, -1, 1))
    assert not parse_unit("-").measures((0, 0, 0, 1))


def read(tmp_path, text, *said, name="run.csv", encoding=""):
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return read_results([file], JUKI, said, encoding)


def message(tmp_path, text, *said):
    with pytest.raises(LinkproofError) as caught:
        read(tmp_path, text, *said)
    return str(caught.value).replace(f"{tmp_path}/", "")


def test_plots_of_solidworks_in_one_file_have_a_time_each(tmp_path):
    torque = [Channel("Time", "sec", TIME), Channel("Motor Torque12", "newton-millimeter", 1e3 * TIME)]
    angle = [Channel("Time", "sec", TIME[::2]), Channel("Angular Displacement1", "deg", 360.0 * TIME[::2])]
    force = [Channel("Time", "sec", TIME), Channel("Reaction Force3", "newton", TIME)]
    plots = [("Motor Torque12", torque), ("Angular Displacement1", angle), ("Reaction Force3", force)]
    with pytest.raises(LinkproofError, match=r"run.csv:11 .*at least 4 instants, got 3"):
        read(tmp_path, solidworks(plots))
    angle = [Channel("Time", "sec", TIME), Channel("Angular Displacement1", "deg", 360.0 * TIME)]
    results = read(tmp_path, solidworks([plots[0], ("Angular Displacement1", angle), plots[2]]))
    assert [(s.name, s.time[-1], s.values[-1]) for s in results.signals] == [
        ("Mkr", 1.0, 1.0),
        ("phi", 1.0, 2.0 * np.pi),
    ]
    assert results.signals[1].assumption == "its name has no link: taken as the crank's"
    ((column, reason),) = results.not_judged
    assert column.header == "Reaction Force3 (newton)"
    assert "fits none of joint_force:A, joint_force:D, joint_force:O1, joint_force:needle_bar on ground" in reason


def test_modelica_files_are_in_si_units_and_that_is_said(tmp_path):
    text = "time,crank.phi,motor.tau,valve.x\n0,0,1,3\n1,2,3,4\n2,3,4,5\n3,4,5,6\n3,4,9,6\n"
    results = read(tmp_path, text)
    assert [signal.name for signal in results.signals] == ["phi", "Mkr"]
    assert results.signals[1].values.tolist() == [1.0, 3.0, 4.0, 9.0]
    assert results.signals[1].assumption == (
        "no unit: in SI units, as Modelica writes it; of instants written more than once the last is taken (1 left out)"
    )


def test_the_crank_angle_is_the_axis_where_there_is_no_time(tmp_path):
    (signal,) = read(tmp_path, "Kurbelwinkel [°];Antriebsmoment [Nm]\n0;1,5\n-10;2,5\n-20;3\n-30;4\n").signals
    assert (signal.name, signal.axis) == ("Mkr", "phi")
    np.testing.assert_allclose(signal.time, -np.radians([0.0, 10.0, 20.0, 30.0]))
    np.testing.assert_allclose(signal.rounding, 0.05)


def test_what_only_the_user_can_tell_is_asked_for(tmp_path):
    text = f"Time,Torque\n{ROWS}"
    assert "of time in the header 'Time', got none; add it with --map \"Time=time [s]\"" in message(tmp_path, text)
    (signal,) = read(tmp_path, text, "Time=time [s]", "Torque=Mkr [N*mm]").signals
    np.testing.assert_allclose(signal.values, [1.5e-3, 2.25e-3, 3e-3, 4e-3])
    (tmp_path / "columns.txt").write_text("Time=time [s]\n\nTorque = Mkr [N*mm]\n")
    assert read(tmp_path, text, str(tmp_path / "columns.txt")).signals[0].values.tolist() == signal.values.tolist()


def test_what_is_said_of_a_column_is_an_equation_that_is_solved_for_the_signal(tmp_path):
    text = f"Zeit [s],Moment [Nmm]\n{ROWS}"
    (plain,) = read(tmp_path, text).signals
    agreed = read(tmp_path, text, "Moment [Nmm]=-2*Mkr [N*mm] + 0.5 @ +0.25 s")
    (signal,) = agreed.signals
    np.testing.assert_allclose(-2.0 * signal.values + 0.5e-3, plain.values)
    np.testing.assert_allclose(signal.time, plain.time + 0.25)
    np.testing.assert_allclose(signal.rounding, 0.5 * plain.rounding)
    assert agreed.corrections == {"Mkr": Correction(-1, 0.5, 0.25, 0.25e-3)}
    assert agreed.read[1][:1] + agreed.read[1][2:] == ("Mkr", 1e-3, "")


@given(
    sign=st.sampled_from([1, -1]),
    numbers=st.tuples(st.floats(1e-6, 1e6), st.floats(-1e3, 1e3), st.floats(-1e6, 1e6)).map(
        lambda each: [float(f"{x:.6g}") if abs(x) > 1e-9 else 0.0 for x in each]
    ),
)
def test_a_correction_that_is_printed_reads_as_itself(sign, numbers):
    factor, shift, offset = numbers
    results = results_of({"Mkr": np.ones(4)}, TIME[:4])
    results = replace(results, read=(("Mkr", replace(results.signals[0].column, unit="N*m"), 1.0, ""),))
    correction = Correction(sign, factor, shift, offset)
    words = results.written("Mkr", correction).removeprefix('--map "').removesuffix('"')
    ((header, entry),) = map_entries([words], ["Mkr"]).items()
    assert (header, entry.signal, entry.unit) == ("Mkr", "Mkr", "N*m")
    read_back = (entry.correction.factor, entry.correction.time_shift, entry.correction.offset)
    assert (entry.correction.sign, read_back) == (sign, pytest.approx(numbers, rel=1e-6))


TORQUE = "Time [s],Torque [Nm]\n"
BAD_FILES = {
    "Time [s],Torque [Nm],Moment [Nmm]\n0,1,2\n1,2,3\n2,3,4\n3,4,5\n": "expected one column for Mkr, got",
    f"foo,Torque [Nm]\n{ROWS}": "run.csv:1: expected a column of time or crank angle, got foo, Torque [Nm]; name",
    f"Time [s],foo\n{ROWS}": "run.csv:1: expected a column that is a signal of juki-mf7923d, got none: 'foo'",
    TORQUE + "0,1\n1,2\n0.5,3\n2,3\n": "(column 1): expected a time that grows in 'Time [s]'",
    "Winkel [deg],Torque [Nm]\n0,1\n1,2\n0.5,3\n2,3\n": "expected a crank angle that runs one way",
    TORQUE + "0,1\n1,2\n": "expected a curve of at least 4 instants, got 2",
    f"Time [s],Torque [furlong]\n{ROWS}": "'furlong' in its name is no unit, link, point or joint",
    TORQUE: "run.csv: expected rows of numbers below a header",
    TORQUE + "0,1\n1,nan\n2,3\n": "run.csv:3: expected a finite number in column 2, got 'nan'",
    TORQUE + "0,1\n1,1e300\n2,2\n": "run.csv:3: expected a finite number in column 2, got '1e300'",
    TORQUE + "0,abc\n1,2\n2,3\n": "run.csv:2: expected a finite number in column 2, got 'abc'",
    TORQUE + "0,٣\n1,1\n2,2\n": "run.csv:2: expected a finite number in column 2, got '٣'",
    TORQUE + "0,1\n1,2,3\n": "run.csv:3: expected 2 columns, as in the first row of the table, got 3",
    TORQUE + "0,0,1,0\n0,1,1,0\n": "with decimal commas columns are parted by semicolons or tabs",
    f"{TORQUE}{ROWS}5,{'1' * 10**6}\n": "run.csv:6: expected a finite number in column 2, got '111",
    f"Time [s],{'Drehmoment' * 500}\n{ROWS}": "'DrehmomentDrehmoment",
    "0,1\n1,2\n": "'column 1' is not judged",
    "0\n1\n": "a column of time or crank angle and others beside it, got none",
    "t [s];M [Nm]\n0;1\n1;2\n# a comment\n2;3\n": "run.csv:4: expected a header for each of the 2 columns",
    "t [s];M [Nm];S [mm]\n0;1;2\n1;;3\n": "run.csv:3: expected a finite number in column 2, got an empty cell",
    ("a note\n" * 50 + "t [s],M [Nm]\n0,1\n") * 99: "run.csv:5099: expected at most 5000 lines of text",
    "t [s]" + ",M [Nm]" * 20_000 + "\n0" + ",1" * 20_000: "run.csv:2: expected at most 10000 columns and",
    "t [s],M [Nm],M [Nm]\n0,1,2\n1,2,3\n": "got 'M [Nm]' (run.csv:1 (column 2)) and 'M [Nm] #2'",
    "": "run.csv: expected rows of numbers",
    b"PK\x03\x04rest": "got a binary file; export the results as CSV",
    bytes(range(256)): "expected text in",
    b"Time [s],M [Nm]\n0,1\n\x81\x8d,3\n": "run.csv:3: expected text in UTF-8, got other bytes; name",
}


@pytest.mark.parametrize(("text", "expected"), BAD_FILES.items(), ids=BAD_FILES.values())
def test_bad_files_are_told_in_one_sentence(tmp_path, text, expected):
    assert expected in message(tmp_path, text)


BAD_ENTRIES = {
    "Torque [Nm]=Mk": "--map 'Torque [Nm]=Mk': unknown signal 'Mk': did you mean",
    "Tim=time [s]": "--map 'Tim=time [s]': unknown column 'Tim': did you mean",
    "Time [s]=time [mm]": "--map 'Time [s]=time [mm]': unknown unit of time 'mm'",
    "Torque=0*Mkr": "--map: expected COLUMN=SIGNAL [UNIT], such as \"Motor Torque12=-Mkr [N*mm]\", got 'Torque=0*Mkr'",
    "Torque=Mkr [N*m] + x": "--map: expected COLUMN=SIGNAL [UNIT]",
    "=Mkr": "--map: expected COLUMN=SIGNAL [UNIT]",
    "columns.txt": "or a file of such lines, got 'columns.txt', which does not exist",
}


@pytest.mark.parametrize(("entry", "expected"), BAD_ENTRIES.items(), ids=BAD_ENTRIES.values())
def test_what_cannot_be_said_of_a_column_is_refused(tmp_path, entry, expected):
    assert expected in message(tmp_path, f"{TORQUE}{ROWS}", entry)


def test_two_entries_of_a_column_are_refused(tmp_path):
    said = ("Torque=Mkr [N*m]", "Torque=phi [deg]")
    assert "expected one entry for a column, got two" in message(tmp_path, f"Time,Torque\n{ROWS}", *said)


def test_equal_headers_of_several_files_are_numbered_and_a_time_that_is_ignored_leaves_the_angle(tmp_path):
    for number in (1, 2):
        (tmp_path / f"{number}.csv").write_text(f"t [s],phi [rad],M [Nm]\n0,0,{number}\n1,1,2\n2,2,3\n3,4,5\n")
    files = [tmp_path / "1.csv", tmp_path / "2.csv"]
    (signal,) = read_results(files, JUKI, ["t [s]=", "M [Nm]="]).signals
    assert (signal.axis, signal.column.header, signal.values[0]) == ("phi", "M [Nm] #2", 2.0)
    assert signal.time.tolist() == [0.0, 1.0, 2.0, 4.0]


def test_folders_missing_files_and_pipes_are_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe.csv")
    refused = {
        ".": "which is a folder", "no.csv": "which does not exist", "pipe.csv": "which is a pipe or a device",
    }  # fmt: skip
    for name, expected in refused.items():
        with pytest.raises(LinkproofError, match=expected):
            read_results([tmp_path / name], JUKI)


@pytest.mark.parametrize("head", ["sep=;\nвремя, с;Момент двигателя, Н·м", "час [s];кут [°]"])
def test_an_encoding_that_is_named_is_read(tmp_path, head):
    (signal,) = read(tmp_path, f"{head}\n0;1\n1;2\n2;3\n3;4\n".encode("cp1251"), encoding="cp1251").signals
    assert signal.name in ("phi", "Mkr")
    assert len(signal.values) == 4


def test_a_name_that_is_no_encoding_is_refused(tmp_path):
    with pytest.raises(LinkproofError, match="--encoding: expected the name of an encoding, such as cp1252, got 'cp9'"):
        read(tmp_path, f"{TORQUE}{ROWS}", encoding="cp9")
