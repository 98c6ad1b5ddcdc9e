"""What headers and their units mean: what any engineer reads in them, in English, German, Ukrainian and Russian."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from comparisons.imported.columns import Column
from comparisons.imported.headers import HeaderParser, NotJudgedError, parse_unit
from tests.analytic.drives import driven

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
