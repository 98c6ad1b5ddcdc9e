"""What headers mean: signals that any engineer would read in them, in twelve languages, and what is left open."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from analytic.description.loading import load, parse
from analytic.errors import LinkproofError
from comparisons.imported.columns import Column
from comparisons.imported.headers.meaning import NotJudgedError, Recognition
from tests.analytic.drives import driven

READ = Recognition(load("juki-mf7923d"))

MEANT = {
    "time": ("Time (sec)", "time", "t", "t/s", "t [s]", "time_s", "Zeit in s", "Temps (s)", "tiempo [s]", "время, с",
             "Час (с)", "czas [s]", "时间 (s)", "時間 (s)", "simTime (ms)"),
    "Mkr": ("Motor Torque12 (newton-meter)", "Torque", "torque_Nm", "M/Nm", "M (Nm)", "Mkr [N*m]",
        "Antriebsmoment [Nm]",
            "Drehmoment (N·m)", "couple moteur (N·m)", "coppia motore [Nm]", "par motor (N·m)", "крутящий момент, Н·м",
            "Момент двигателя (Н·м)", "Крутний момент (Н·м)", "moment obrotowy silnika [Nm]", "电机扭矩 (N·m)",
            "モータートルク (N·m)", "motor.tau", "MOTION_1.TZ", "Motor [Nm]", "DriveTorque [in-lb]",
            "Torque (Motor1)", "Torque RotaryMotor1 (N*mm)"),
    "phi": ("Angular Displacement1 (deg)", "Kurbelwinkel [°]", "Crank angle", "φ/°", "crank.phi", "phi", "Angle (rad)",
            "Winkel (deg)", "Угол поворота кривошипа (град)", "кут кривошипа (град)", "angle de manivelle (°)",
            "kąt korby [deg]", "曲柄转角 (deg)", "クランク角度 (deg)", "ángulo (rad)"),
    "omega": ("Angular Velocity1 (deg/sec)", "Motor Speed (rpm)", "Drehzahl [1/min]", "Speed [rpm]", "crank.w",
              "Kurbelwinkelgeschwindigkeit (rad/s)", "угловая скорость кривошипа, рад/с", "кутова швидкість (рад/с)",
              "vitesse angulaire (rad/s)", "velocidad angular (rpm)",
              "prędkość kątowa korby [rad/s]", "曲柄角速度 (rad/s)"),
    "epsilon": ("Angular Acceleration3 (deg/sec**2)", "Winkelbeschleunigung (rad/s^2)", "α (rad/s²)",
        "angular_accel_rad/s2"),
    "Peq": ("Power Consumption1 (watt)", "Leistung [W]", "Puissance (W)", "moc silnika [W]", "мощность двигателя (Вт)"),
    "Teq": ("Kinetic Energy (J)", "kinetische Energie [J]", "Énergie cinétique (J)", "кінетична енергія (Дж)",
        "Ekin [mJ]"),
    "Jeq": ("Jeq (kg m^2)", "Reduced inertia (kg·mm²)"),
    "S": ("S (mm)", "s [mm]", "Linear Displacement2 (mm)", "Weg [mm]", "位移 (mm)", "Slider displacement (mm)"),
    "v": ("Linear Velocity1 (mm/sec)", "скорость ползуна (м/с)", "v [m/s]", "Speed (mm/s)"),
    "a": ("Linear Acceleration (mm/sec**2)", "a [m/s^2]", "Beschleunigung [m/s²]"),
    "point:D:x": ("D.x", "D_x [mm]", "x_D (mm)", "coupler.D.x (m)", "Position D X [in]", "point:D:x"),
    "point:D:vy": ("D.vy (m/s)", "Velocity D Y (mm/s)", "D.y [m/s]", "Скорость D y (м/с)"),
    "link:coupler:angle": ("coupler.phi", "Angle coupler (deg)", "coupler angle [rad]", "link:coupler:angle"),
    "link:coupler:omega": ("Angular Velocity coupler (rad/s)", "coupler.w", "coupler.WZ (deg/sec)"),
    "joint_force:A:x": ("Reaction Force A X (newton)", "JOINT_A.FX", "A.x [N]", "Gelenkkraft A x [N]",
        "сила реакции A x (Н)"),
    "joint_force:A:magnitude": ("Reaction Force A (N)", "Gelenkkraft A Betrag [N]", "Reaction force magnitude A [lbf]"),
    "joint_force:needle_bar on ground:x": ("needle_bar on ground FX (N)", "joint_force:needle_bar on ground:x [N]"),
    "shaking_force:x": ("Shaking Force X (N)",),
}  # fmt: skip
OPEN = {
    "Reaction Force1 (newton)": "its name fits none of joint_force:A, joint_force:D, joint_force:O1",
    "Trace Path1 (mm)": "its name fits none of S, point:A, point:D",
    "Energy [J]": "its name fits none of Teq",
    "Torque (mm)": "'mm' is no unit of Mkr",
    "foo": "'foo' in its name",
    "revolute1.tau": "its name fits none of Mkr",
    "Speed": "it may be omega, v: add its unit",
    "Reaction Moment3 (newton-millimeter)": "its name fits none of Mkr",
    "Spring force (N)": "no such quantity",
    "Motor Torque X (Nm)": "its name fits none of Mkr",
    "D.z (mm)": "its name fits none of S, point:A",
    "D (mm)": "its name fits none of S, point:A",
    "Torque coupler (Nm)": "its name fits none of Mkr",
    "O1.x (mm)": "its name fits none of S, point:A",
    "A D x (mm)": "its name fits none of S, point:A",
    "Angular Velocity D (rad/s)": "its name fits none of omega",
    "Temperature [K]": "in its name",
    "Torque [furlong]": "'furlong' in its name is no unit",
    "Torqe motor (Nm)": "'Torqe' in its name is no unit, link, point or joint, nor a known word",
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


@pytest.mark.parametrize(("header", "reason"), OPEN.items())
def test_what_may_be_two_things_or_none_is_left_open_with_the_reason(header, reason):
    with pytest.raises(NotJudgedError) as caught:
        READ.meaning(_column(header))
    assert reason in str(caught.value)


def test_what_is_taken_is_said():
    taken = {
        "Torque [Nm]": "its name has no link: taken as the crank's",
        "Angle (deg)": "its name has no link: taken as the crank's",
        "Motor Torque (Nm)": "",
        "Weg [mm]": "taken as the output's, D along [0, 1]",
        "Reaction Force A (N)": "its name has no component: taken as the size of the force",
    }
    assert {header: READ.meaning(_column(header)).taken for header in taken} == taken


def test_a_force_that_changes_its_sign_is_not_the_size_of_a_force():
    with pytest.raises(NotJudgedError, match="changes its sign"):
        READ.meaning(_column("Reaction Force A (N)", (1.0, -1.0)))


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
    read = Recognition(parse(text, "letters", "letters.toml"))
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


def test_long_headers_are_looked_at_in_no_time():
    for header in (
        "(" * 100_000,
        "a " * 100_000,
        "in " * 50_000,
        "x_" * 50_000,
        "moment" * 20_000,
        "[" + "(x)" * 50_000,
    ):
        with pytest.raises(NotJudgedError):
            READ.meaning(_column(header))


def test_a_cylinder_has_a_length_a_speed_and_a_force():
    read = Recognition(driven("cylinder-in-the-loop").linkage)
    meant = {
        "phi": ("Cylinder length [mm]", "Zylinderlänge (mm)", "Zylinderweg [mm]", "longueur du vérin (mm)",
                "Довжина циліндра, мм"),
        "omega": ("Cylinder speed (mm/s)", "Actuator velocity [m/s]"),
        "Mkr": ("Cylinder force [N]", "Zylinderkraft [kN]", "Усилие гидроцилиндра, Н", "Hydraulikkraft (N)"),
    }  # fmt: skip
    for signal, headers in meant.items():
        assert {read.meaning(_column(header)).signal for header in headers} == {signal}
    for any_drive in (read, READ):
        with pytest.raises(NotJudgedError):
            any_drive.meaning(_column("Length [mm]"))
