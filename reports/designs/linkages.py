"""``linkproof new``, ``check`` and ``list``: a linkage file to fill in, its review, the linkages known by name."""

from __future__ import annotations

import json
import os
import re
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final

from analytic.description.json_schema import TITLE, json_schema
from analytic.description.linkage import Linkage
from analytic.description.loading import BYTE_ORDER_MARK, LinkageFile
from analytic.description.written import finite, in_unit
from analytic.designs.figures import figure_names
from analytic.errors import LinkproofError, is_safe
from analytic.files import read_file
from analytic.kinematics.mechanism import Mechanism
from comparisons.designer import linkage_check
from comparisons.designer.curves import Curves
from comparisons.designer.figures import case_figures
from comparisons.designer.linkage_check import check_slips
from comparisons.motion.case import Case
from comparisons.trials.runs.files import check_writable, write_file
from reports.designs.shelves import Listing
from reports.document.numbers import ABSENT, printed
from reports.document.parts import Paragraph, Table
from reports.document.study import PICTURES, Content, Study
from reports.document.terminal import Printed, Printout
from reports.mechanism.fact_words import review_words, warning_words

if TYPE_CHECKING:
    from matplotlib.figure import Figure


TEMPLATE: Final = Path(json_schema.__code__.co_filename).with_name("new.toml")
SCHEMA_FILE: Final = "linkproof.schema.json"
SCHEMA_LINE: Final = "#:schema"


def new(name: str, like: LinkageFile | None = None) -> New:
    """Write the linkage file ``name``.toml to fill in, or a copy of ``like``, and the schema by which editors check it.

    The schema, beside it, is renewed, but one of somebody else stays. Raises LinkproofError for a bad name, a file that
    exists or cannot be written, and a ``like`` with a fault.
    """
    path = Path(name if name.lower().endswith(".toml") else f"{name}.toml")
    if path.suffix.lower() != ".toml" or not all(map(is_safe, name)):
        raise LinkproofError(f"expected a name for the new file, got '{name}': give one of letters and digits")
    if os.path.lexists(path):
        raise LinkproofError(f"'{path}' exists already: give another name; linkproof new overwrites nothing")
    check_writable(path)
    schema = path.with_name(SCHEMA_FILE)
    title = json.dumps(path.stem, ensure_ascii=False)[1:-1]
    text = _copy(like, path.stem) if like else TEMPLATE.read_text(encoding="utf-8").replace("{title}", title)
    write_file(path, text)
    beside = ""
    if _is_ours(schema):
        beside = f" and {'renewed ' if schema.exists() else ''}{schema}, by which editors complete and check it"
        write_file(schema, json.dumps(json_schema(), indent=1, ensure_ascii=False) + "\n")
    return New(path, beside)


def _copy(like: LinkageFile, title: str) -> str:
    """The text of a copy of a linkage's file, comments included, with a title of its own and the schema's line.

    Raises LinkproofError for a file with a fault.
    """
    import tomlkit  # noqa: PLC0415 - no other command of this file needs it

    like.linkage()  # a file with a fault is no start for another
    document = tomlkit.parse(like.text.removeprefix(BYTE_ORDER_MARK))
    document["title"] = title
    text = document.as_string()
    return text if text.startswith(SCHEMA_LINE) else f"{SCHEMA_LINE} ./{SCHEMA_FILE}\n{text}"


@dataclass(frozen=True, repr=False)
class New(Study):
    """A new file, at ``path``, and what was written ``beside`` it, in words."""

    suffixes: ClassVar = ()
    path: Path
    beside: str

    def printout(self) -> Printout:
        """The printed paths of the new files, and the next command, in a closing line."""
        argument = shlex.quote(f"./{self.path}" if str(self.path).startswith("-") else str(self.path))
        return Printout((), [f"wrote {self.path}{self.beside}; next: linkproof check {argument}"])

    def to_dict(self) -> Mapping[str, Any]:
        """The path of the new file, JSON-ready."""
        return {"path": str(self.path)}


def _is_ours(path: Path) -> bool:
    """Whether the schema file may be written: there is none, or one that linkproof wrote; no error is raised."""
    try:
        return not os.path.lexists(path) or bool(json.loads(read_file(path, "a schema")).get("title") == TITLE)
    except (LinkproofError, ValueError, AttributeError, RecursionError):
        return False


def review(linkage: Linkage, word: str, *, strict: bool) -> Check:
    """The facts on a linkage, up to its first fault, which is kept and not raised; ``word`` is the user's name for it.

    With ``strict``, a likely mistake counts as a fault.
    """
    facts, fault = linkage_check.check(linkage)
    if strict and fault is None:
        try:
            check_slips(linkage)
        except LinkproofError as slip:
            fault = slip
    return Check(linkage, word, facts, fault)


@dataclass(frozen=True, repr=False)
class Check(Study):
    """A review: the ``facts``, SI with angles in rad, and the ``fault`` or None.

    ``word`` is the name or path by which a command names the linkage, "" without one.
    """

    suffixes: ClassVar = (".json", *PICTURES, ".dxf")
    linkage: Linkage
    word: str
    facts: Mapping[str, Any]
    fault: LinkproofError | None

    @property
    def exit_code(self) -> int:  # type: ignore[override]
        """The exit code, 0; raises the linkage's fault if there is one."""
        if self.fault is not None:
            raise self.fault
        return 0

    @property
    def ok(self) -> bool:
        """Whether there is no fault."""
        return self.fault is None

    def failures(self) -> Sequence[str]:
        """The linkage's fault, as text, as the only member; "None" without one."""
        return [str(self.fault)]

    def sentence(self) -> Printed:
        """The linkage's fault or, without one, its name and title."""
        return str(self.fault or f"{self.facts['mechanism']} ({self.facts['variant']}): {self.facts['title']}")

    def printout(self) -> Printout:
        """The printed facts, a line each, then the table of links and the warnings."""
        return Printout(printed_facts(self.facts, self.linkage.written), ())

    def to_dict(self) -> Mapping[str, Any]:
        """The facts, JSON-ready."""
        return self.facts

    def plot(self) -> Figure:
        """The scheme in twelve positions of its range, a figure of matplotlib.

        Raises LinkproofError for a linkage that cannot be assembled.
        """
        from comparisons.designer.building import positions_over_range  # noqa: PLC0415 - matplotlib takes a second
        from reports.charts.scheme import scheme_figure  # noqa: PLC0415

        return scheme_figure(self.linkage, positions_over_range(Mechanism(self.linkage)))

    def content(self, suffix: str, **form: Any) -> Content:  # noqa: ANN401
        """The content of a file with this suffix: JSON, the text of a DXF drawing at the sketch, or a picture.

        Raises the fault of a linkage that cannot be drawn.
        """
        if suffix != ".json" and self.fault is not None:
            raise self.fault
        if suffix != ".dxf":
            return super().content(suffix, **form)
        from comparisons.designer.building import positions_over_range  # noqa: PLC0415 - ezdxf takes half a second
        from reports.designs.results_dxf import dxf  # noqa: PLC0415

        return dxf(self.linkage, positions_over_range(Mechanism(self.linkage)))

    def save(self, *files: str | Path, **form: Any) -> list[Path]:  # noqa: ANN401
        """Write files and return their paths; of a linkage with a fault only its facts, as .json.

        If that leaves a file out, the fault is raised. Raises LinkproofError for a file that cannot be written.
        """
        facts = [file for file in files if Path(file).suffix.lower() == ".json"]
        super().save(*(facts if self.fault else files), **form)
        if self.fault and len(facts) < len(files):
            raise self.fault
        return [Path(file) for file in files]

    def hint(self, saved: Sequence[Path]) -> str:
        """A hint, after a blank line, with the command that draws the linkage.

        "" where a file was saved, there is a fault or the command has no word.
        """
        if saved or self.fault or not self.word:
            return ""
        return f"\nscheme       linkproof check {shlex.quote(self.word)} --save scheme.svg draws it"


def printed_facts(facts: Mapping[str, Any], written: Callable[[float], str]) -> list[Printed]:
    """The printed parts of a review: heading, a line for each fact, then the table of links and warnings.

    ``written`` writes a length, m, in the file's unit.
    """
    heading = Paragraph(f"{facts['mechanism']} ({facts['variant']}): {facts['title']}", colour="bold")
    words = [f"{name:<12} {fact}" for name, fact in review_words(facts, written)]
    warnings = [Paragraph(f"warning: {text}", colour="yellow") for text in warning_words(facts, written)]
    head = ("link", "mass kg", "inertia kg m²", "mean Jeq kg m²", "points")
    links = Table("", head, list(_links(facts["links"])), "lrrrl")
    return [heading, *words, "", links, *warnings]


def _links(links: Mapping[str, Mapping[str, Any]]) -> Iterator[tuple[str, ...]]:
    """Yield the cells of each link as texts: name, mass, inertia, mean Jeq, SI, points; "-" for what it lacks."""
    for name, link in links.items():
        inertia = "-" if link["inertia"] is None else f"{link['inertia']:.4g}"
        mean = f"{link['Jeq_mean']:.4g}" if "Jeq_mean" in link else "-"
        yield name, f"{link['mass']:.4g}", inertia, mean, ", ".join(link["points"])


TOUCH: Final = 1e-9  # of the largest of its kind: the least magnitude of what passes zero is known no nearer


def listed_figures(mechanism: Mechanism, conditions: str, case: Case) -> Listing:
    """Every figure of a design under a motion, extremes refined, and every number, in file units, as a Listing.

    ``conditions`` are those of the ``case`` in words. A number has the digits that give its value back. Raises
    LinkproofError where the linkage cannot make the motion.
    """
    from comparisons.designer.parameters import named_figures, parameters  # noqa: PLC0415 - check needs no designs

    linkage = mechanism.linkage
    every = named_figures(mechanism, figure_names(mechanism))
    curves = Curves(case)  # of one design, all figures are found together
    found = case_figures(curves, {each.name: each.figure for each in every})
    values = [found[each.name] / each.unit.size for each in every]
    sizes: dict[tuple[str, str], float] = {}  # of signals of one kind, beside which a value may be rounding
    kinds = [(re.split("[:.@]", each.name)[0], each.unit.name) for each in every]
    for kind, value in zip(kinds, values, strict=True):
        sizes[kind] = max(sizes.get(kind, 0.0), abs(finite(value) or 0.0))
    figures = [
        {
            "name": each.name,
            "units": each.unit.name,
            "value": 0.0 if abs(value) <= TOUCH * sizes[kind] else finite(float(f"{value:.15g}")),
        }
        for each, value, kind in zip(every, values, kinds, strict=True)
    ]
    numbers = [
        {"name": each.name, "units": each.unit.name, "value": in_unit(each.value, each.unit.size)}
        for each in parameters(linkage).values()
    ]
    beside = (
        "Figures stand to six digits; --json gives them in full. "
        f"You can also vary speed, {linkage.phi.speed_unit.name}."
    )
    parts: list[Printed] = [
        Paragraph(conditions, colour="bold"),
        "",
        _values_table("figure", figures, lambda value: ABSENT if value is None else printed(value)),
        "",
        _values_table("number", numbers, lambda value: repr(value).removesuffix(".0")),
        "",
        beside,
    ]
    about = {"mechanism": linkage.name, "variant": linkage.variant, "conditions": conditions}
    return Listing(parts, {**about, "figures": figures, "numbers": numbers})


def _values_table(what: str, rows: Sequence[Mapping[str, Any]], written: Callable[[Any], str]) -> Table:
    """A table of names, units and values, of ``rows`` with "name", "units" and "value"; ``what`` heads the names.

    ``written`` turns a value into text.
    """
    cells = [(row["name"], row["units"], written(row["value"])) for row in rows]
    return Table("", (what, "unit", "value"), cells, "llr")
