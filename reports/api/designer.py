"""What a designer asks of a linkage: its signature is the option on the command line, its docstring the documentation.

Every function takes the name of a mechanism of the catalogue, the path of a .toml file, a loaded linkage or a mapping
of the form of a file, and raises LinkproofError for bad input; all but ``evaluate`` return a study. ``announce`` gets
the label of each part of the work as it begins, its number and the number of all. Help and completion read the
signatures alone: what computes is imported when it is called.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from analytic.errors import LinkproofError, symbol
from reports.api.options import (
    Announce,
    Argument,
    LinkageLike,
    Mechanism,
    Motion,
    Numbers,
    Option,
    Positive,
    Ranges,
    SteadyMotion,
    Strict,
    Variant,
    Words,
    checked,
    command_line,
    silent,
    words,
)

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

    from reports.designs.linkages import Check, New
    from reports.designs.optimise import Optimisation
    from reports.designs.results import Results
    from reports.designs.shelves import Listing
    from reports.designs.sweep import DesignSweep, LazySweep
    from reports.designs.tolerance import Tolerance
    from reports.studies.judged import Judgement

ScaleMass = Annotated[bool, Option("Scale mass and inertia of a link with its lengths; default: as in the file.")]


@checked
def mechanisms(
    mechanism: Annotated[LinkageLike | None, Argument("MECHANISM", "mechanisms")] = None,
) -> "Listing":
    """List the mechanisms of the catalogue, or the figures and numbers of one.

    Of the catalogue the variants and sources are listed, too.

    MECHANISM is a name in the catalogue or the path of a .toml file: its figures for sweep, optimise and tolerance are
    listed, and the numbers that they can vary, in the units of the file.

    >>> linkproof.mechanisms("juki-mf7923d").to_dict()["numbers"][0]
    {'name': 'coupler.mass', 'units': 'kg', 'value': 0.03}
    """
    if mechanism is None:
        from reports.designs.shelves import listed_mechanisms

        return listed_mechanisms()
    from reports.api.linkages import load_linkage
    from reports.api.motions import requested_case
    from reports.api.steady import steady_case
    from reports.designs import linkages

    motion = SteadyMotion()
    found = steady_case(load_linkage(mechanism), motion)
    return linkages.listed_figures(found.mechanism, found.conditions, requested_case(motion.motion, found.mechanism))


@checked
def new(
    name: Annotated[str, Argument("NAME")],
    *,
    like: Annotated[
        LinkageLike | None,
        Option("Copy this linkage, a name in 'linkproof list' or a file.", "MECHANISM", names="mechanisms"),
    ] = None,
) -> "New":
    """Write a linkage file to fill in.

    NAME.toml is a small linkage with every key explained, as a start for yours; nothing is overwritten.

    With --like the file is a copy of that linkage, comments included, under the new name.

    Also writes linkproof.schema.json, so that editors complete and check the file (VS Code: Even Better TOML); one
    that is there already is renewed.

    >>> linkproof.new("press").path.name
    'press.toml'
    """
    from reports.api.linkages import linkage_file
    from reports.designs import linkages

    return linkages.new(name, None if like is None else linkage_file(like))


@checked
def check(mechanism: Mechanism, variant: Variant = None, *, strict: Strict = False) -> "Check":
    """Review a linkage: mobility, groups, range, links, errors.

    The review also has transmission angles, toggles, Jeq and the stroke.

    MECHANISM is the path of a .toml file or a name in the catalogue.

    Stops at the first error and states it in one sentence, with exit code 2.

    In Python the facts are in SI with angles in rad, and a fault is one of them.

    >>> f"{1000 * linkproof.check('juki-mf7923d').facts['output']['stroke']:.2f} mm"
    '31.00 mm'
    """
    from reports.api.linkages import load_linkage
    from reports.designs.linkages import review

    word = str(mechanism) if isinstance(mechanism, str | Path) else ""
    return review(load_linkage(mechanism, variant), word, strict=strict)


@checked
def results(
    mechanism: Mechanism,
    motion: Motion = Motion(),
    *,
    at: Annotated[Numbers | None, Option("Every signal at these crank angles: 0,30,60.", "DEGREES")] = None,
    time: Annotated[Numbers | None, Option("Every signal at these times: 0.1,0.2.", "SECONDS")] = None,
    strict: Strict = False,
) -> "Results":
    """Compute peaks, bearing forces and every signal of one linkage, without an engine.

    Signals are torque, power, forces and positions, as a designer needs them.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Tables, CSV and SVG are in the units of the file, JSON is in SI with angles in rad.

    In Python ``at`` (n,) is in degrees, ``time`` (n,) in s; ``dataset`` is in SI with angles in rad. Moments are
    positive counter-clockwise, and a joint's force acts on its first link.

    >>> torque = linkproof.results("juki-mf7923d", linkproof.Motion(speed=3000))["torque"]
    >>> f"{float(abs(torque).max()):.3f} {torque.units} at {float(abs(torque).idxmax()):.3f} rad"
    '1.293 N m at 4.084 rad'
    """
    from comparisons.designer.linkage_check import check_slips
    from reports.api.linkages import resolve
    from reports.api.motions import requested_results
    from reports.designs.results import Results

    chosen, _, motion = resolve(mechanism, motion)
    if strict:
        check_slips(chosen)
    return Results(*requested_results(chosen, motion, at, time))


def evaluate(
    linkage: LinkageLike,
    phi: "ArrayLike",
    quantities: Words | None = None,
    *,
    variant: str | None = None,
    speed: "ArrayLike | None" = None,
    acceleration: "ArrayLike" = 0.0,
    gravity: bool = True,
    designs: "Mapping[str, ArrayLike] | None" = None,
) -> "xarray.Dataset":
    """Quantities of the closed form over crank angles ``phi`` (n,), rad; all available ones if none are named.

    They have the names and signs of ``results``; ``Q``, ``half_slope``, ½ dJeq/dφ, and ``damping`` are added, and a
    link's share ``Jeq:LINK`` where it is named. ``speed``, rpm, and ``acceleration``, rad/s², are a number or (n,);
    quantities of motion need a speed. ``designs`` has arrays (k,) of numbers of the linkage, SI, by their names in its
    file: the Dataset is then over ``design`` and ``phi``, without signals of parts and without S, and NaN where
    ``assembled`` is False. A drive along a line has m, its file's unit of length per second and m/s² in place of rad,
    rpm and rad/s². Raises LinkproofError for bad input.

    >>> linkproof.evaluate("juki-mf7923d", [0.0, 1.0], "inertia")["Jeq"].values.round(8)
    array([8.963e-05, 7.318e-05])
    """
    import numpy as np

    from analytic.kinematics.mechanism import Mechanism
    from reports.api.linkages import load_linkage
    from reports.designs.labels import evaluated, evaluated_designs

    mechanism = Mechanism(load_linkage(linkage, variant, gravity=gravity))
    angle = np.atleast_1d(np.asarray(phi, dtype=float))
    if angle.ndim != 1 or not angle.size or not np.all(np.isfinite(angle)):
        got = "nan or infinity" if angle.ndim == 1 and angle.size else f"shape {angle.shape}"
        raise LinkproofError(f"phi: expected a flat list of finite crank angles, got {got}; pass such a list")
    size = mechanism.linkage.phi.speed_unit.size
    moves = {"acceleration": acceleration, "speed": None if speed is None else np.asarray(speed, dtype=float) * size}
    names = None if quantities is None else [*map(symbol, words(quantities))]
    if designs is None:
        return evaluated(mechanism, angle, names, moves)
    return evaluated_designs(mechanism, angle, names, designs, moves)


@checked
def sweep(
    mechanism: Mechanism,
    vary: Annotated[
        Mapping[str, Any] | Sequence[str],
        Option(
            "Values of a number of the file or of the speed, in the file's units or others: rod.B.x=17cm:18cm:100; "
            "several make a grid.",
            "NAME=FIRST:LAST:COUNT",
            names="parameters",
        ),
    ] = (),
    quantity: Annotated[
        Sequence[str],
        Option(
            "Figure of a design: SIGNAL.peak, .mean, .rms, .max, .min or .range, SIGNAL@DEGREES, joint_force.peak of "
            "every joint, stroke; repeatable; default: peaks of torque and joint forces, least transmission angles, "
            "the stroke.",
            "NAME",
            names="figures",
        ),
    ] = (),
    motion: SteadyMotion = SteadyMotion(),
    *,
    table: Annotated[
        "str | Path | Mapping[str, Any] | None",
        Option("Designs one by one: columns rod.B.x or rod.B.x [mm].", "CSV"),
    ] = None,
    scale_mass: ScaleMass = False,
    refine: Annotated[bool, Option("Find the exact extremes between the sampled angles.")] = False,
    announce: Announce = silent,
) -> "DesignSweep | LazySweep":
    """Compute figures of many designs, such as peak torque over a range of lengths.

    The designs of one linkage are a grid of ranges, or a table; no engine is needed.

    MECHANISM is a name in the catalogue or the path of a .toml file.

    Values are in the units of the file. The crank turns at constant speed; extremes are taken at 180 angles, or are
    exact with --refine. A design that does not assemble at one of the angles has no figures.

    In Python ``vary`` may map names to values (n,) each, and ``table`` be a mapping, DataFrame or Dataset of columns;
    if they are Dask arrays, so are the figures, computed chunk by chunk on request, without a limit to their number.

    >>> linkproof.sweep("rimoldi-164", {"rod.B.x": [170, 180]}, "stroke").dataset["stroke"].values.round(3)
    array([31.349, 30.651])
    """
    from comparisons.designer.sweep import given_designs, lazy_dataset
    from comparisons.designer.sweep import sweep as sweep_space
    from reports.api.linkages import resolve
    from reports.api.steady import steady_case, sweep_request
    from reports.designs.sweep import DesignSweep, LazySweep

    chosen, mechanism, motion = resolve(mechanism, motion)
    case = steady_case(chosen, motion, scale_mass=scale_mass, refine=refine)
    space, lazy = given_designs(case, vary, table)
    request = sweep_request(case, space, quantity, refine=refine)
    if lazy is not None:
        return LazySweep(lazy_dataset(request, lazy))
    is_typed = not isinstance(vary, Mapping) and (table is None or isinstance(table, str | Path))
    command = command_line(sweep, locals()) if is_typed else ""  # arrays have no words
    study = sweep_space(request, announce)
    return DesignSweep(study, command)


@checked
def optimise(
    mechanism: Mechanism,
    motion: SteadyMotion = SteadyMotion(),
    *,
    minimise: Annotated[
        str | None, Option("Minimise this figure, such as Mkr.peak.", "FIGURE", names="figures")
    ] = None,
    maximise: Annotated[str | None, Option("Maximise it: transmission_angle.min.", "FIGURE", names="figures")] = None,
    over: Annotated[
        Ranges,
        Option(
            "A number of the file, or the speed, to vary within bounds, or NAME=±10%; repeatable.",
            "NAME=LOW:HIGH",
            names="parameters",
        ),
    ] = (),
    keep: Annotated[
        Ranges,
        Option(
            "Hold a figure at its present value, at =VALUE, or in a range; repeatable.",
            "FIGURE[=LOW:HIGH]",
            names="figures",
        ),
    ] = (),
    scale_mass: ScaleMass = False,
    everywhere: Annotated[bool, Option("Search the whole region within the bounds.", flags=("--global",))] = False,
    step: Annotated[
        str | None, Option("Round lengths to this step, such as 0.1mm, and report the loss.", "STEP", ("--round",))
    ] = None,
    announce: Announce = silent,
) -> "Optimisation":
    """Find the best lengths: the smallest peak torque at the same stroke, for example.

    Values vary within bounds, and the results that you choose are held; all in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file; values are in the units of the file.

    Figures are those of sweep: a peak is the largest magnitude. joint_force.peak is that of all joints together.

    In Python ``over`` and ``keep`` may map names to (170, 180) or "±10%", to a number, or to None, which holds the
    file's own value; None within a pair means unbounded.

    >>> linkproof.optimise("rimoldi-164", minimise="Mkr.peak", over={"rod.B.x": "±2%"}, keep={"stroke": (30, 32)})
    <Optimisation: least Mkr.peak: from 0.270411 to 0.250060 N*m at rod.B.x 172.074 mm>
    """
    from comparisons.designer.optimisation import optimise as find_optimum
    from comparisons.designer.parameters import mass_words
    from reports.api.linkages import resolve
    from reports.api.steady import aim, check_words, steady_case
    from reports.designs.optimise import Optimisation

    chosen, mechanism, motion = resolve(mechanism, motion)
    command = command_line(optimise, locals())
    figure, is_least, step = aim(minimise, maximise), maximise is None, step or ""
    case = steady_case(chosen, motion, scale_mass=scale_mass)
    best = find_optimum(
        case, figure, tuple(over), tuple(keep), is_least=is_least, everywhere=everywhere, step=step, announce=announce
    )
    conditions = case.conditions + mass_words(case.mechanism.linkage, best.after)
    return Optimisation(best, conditions, command, check_words(best, motion))


@checked
def tolerance(
    mechanism: Mechanism,
    tolerances: Annotated["str | Path | Mapping[str, Any]", Argument("TOLERANCES.toml")],
    results: Words | None = None,
    motion: SteadyMotion = SteadyMotion(),
    *,
    scale_mass: ScaleMass = False,
    samples: Annotated[
        int | None, Option("Random designs; default: 10000, 200 where a group has no closed form.", "N")
    ] = None,
    announce: Announce = silent,
) -> "Tolerance":
    """Show which length, angle or mass changes which result by how much.

    Tolerances are taken one by one, in the worst case and in random designs; all in closed form.

    MECHANISM is a name in the catalogue or the path of a .toml file. Example of TOLERANCES.toml:

    results = ["Mkr.peak", "joint_force:A.peak", "stroke"]; speed = 1000; and under [tolerances] the ± of numbers of the
    linkage's file, in its units or one of their own, and of the speed: "rod.B.x" = 0.05, "rocker.C.x" = "50um",
    speed = 10, "rod.mass" = { plus_minus = 0.01, distribution = "uniform" } (else normal: the ±
    are three standard deviations).

    In Python ``tolerances`` may map names to their ±, and ``results`` name what the file would; the speed of the motion
    precedes that of the file.

    >>> found = linkproof.tolerance("rimoldi-164", {"rod.B.x": 0.05}, "stroke", samples=1000)
    >>> found.dataset.attrs["samples"]
    1000
    """
    from comparisons.designer.tolerances import Tolerances, read_tolerances, tolerance_study
    from reports.api.linkages import resolve
    from reports.api.steady import steady_case
    from reports.designs.tolerance import Tolerance

    given = Tolerances((), None, tolerances) if isinstance(tolerances, Mapping) else read_tolerances(Path(tolerances))
    asked = replace(given, results=given.results if results is None else words(results))
    chosen, _, motion = resolve(mechanism, motion)
    if motion.speed is None:
        motion = replace(motion, speed=asked.speed)
    case = steady_case(chosen, motion, scale_mass=scale_mass)
    return Tolerance(tolerance_study(case, asked, samples, announce))


@checked
def judge(
    mechanism: Mechanism,
    results: Annotated[str | Path | Sequence[str | Path], Argument("RESULTS")],
    motion: Motion = Motion(),
    *,
    map: Annotated[
        Sequence[str],
        Option(
            "What a column is, such as 'Motor Torque12=-Mkr [N*mm]', nothing after = to leave it out; or a file of "
            "such lines; repeatable.",
            "COLUMN=SIGNAL",
        ),
    ] = (),
    limit: Annotated[float, Positive("Largest error allowed, as a share of the closed form's peak.", "SHARE")] = 0.01,
    encoding: Annotated[
        str, Option("Encoding of files that are not UTF-8 or UTF-16, such as cp1252 or cp1251.", "NAME")
    ] = "",
) -> "Judgement":
    """Judge a curve from another tool: right or wrong, and the probable cause.

    The tool may be SolidWorks Motion, Adams, Modelica, or any other that exports a CSV with a header.

    MECHANISM is a name in the catalogue or the path of a .toml file, RESULTS are the tool's files.

    The crank's motion is taken from the file's angle or speed column, or from --regime. Nothing in a file is
    interpolated or smoothed; only corrections that --map states are applied.

    Exit codes: 0 every signal within the limit, 1 otherwise, 2 bad input or nothing to judge.

    In Python ``ok`` says whether every signal is within the limit, and ``check`` raises AssertionError if not.

    >>> _ = linkproof.results("juki-mf7923d").save("curves.csv")
    >>> linkproof.judge("juki-mf7923d", "curves.csv").ok
    True
    """
    from reports.api.judging import judge_files
    from reports.api.linkages import resolve
    from reports.studies.judged import Judgement

    chosen, mechanism, motion = resolve(mechanism, motion)
    command = command_line(judge, locals())
    files = [Path(file) for file in words(results)]
    judged = judge_files(chosen, files, motion, map=map, limit=limit, encoding=encoding)
    return Judgement(**vars(judged), paths=tuple(files), command=command)
