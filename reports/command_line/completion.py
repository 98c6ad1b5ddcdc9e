"""Completion in a shell: names of mechanisms, engines, settings, regimes, quantities and stability maps.

A name is one that begins with the incomplete word; the typed words are in COMP_WORDS.
"""

from __future__ import annotations

import contextlib
import os
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

import click

from analytic.errors import LinkproofError
from analytic.files import read_file

if TYPE_CHECKING:
    from click.shell_completion import ShellComplete

    from analytic.description.linkage import Linkage

CATALOGUE = Path(__file__).parents[2] / "analytic" / "catalogue"


def mechanisms(incomplete: str) -> list[str]:
    """Names of the catalogue and paths of linkage files that begin with the incomplete word, sorted.

    There are paths only for a word that is neither empty nor absolute.
    """
    files = Path().glob(f"{incomplete}*.toml") if incomplete and not Path(incomplete).is_absolute() else []
    return [*_completions(_files_by_name(), incomplete), *sorted(map(str, files))]


def variants(incomplete: str) -> list[str]:
    """Variants, beginning with the incomplete word, of the typed mechanisms, sorted."""
    named = [name for table in _linkage_tables() for name in (table.get("variant", "base"), *table.get("variants", {}))]
    return _completions(named, incomplete)


def regimes(incomplete: str) -> list[str]:
    """Names, beginning with the incomplete word, of general regimes and of those in the typed files, sorted.

    "own" and "all" are among them.
    """
    from analytic.description.crank_motion import LAWS, REGIMES

    own = [name for table in _linkage_tables() for name in table.get("regimes", {})]
    return _completions([*REGIMES, *LAWS, *own, "own", "all"], incomplete)


def engines(incomplete: str) -> list[str]:
    """Names of all engines with an adapter that begin with the incomplete word."""
    from engines.registry import engine_names

    return _completions(engine_names(), incomplete)


def settings(incomplete: str) -> list[str]:
    """Names of settings, and "all", that begin with the incomplete word."""
    from engines.contract import Setting

    return _completions([*Setting, "all"], incomplete)


def quantities(incomplete: str) -> list[str]:
    """Names of quantities that begin with the incomplete word."""
    from comparisons.trials.judging.quantities import QUANTITIES

    return _completions(QUANTITIES, incomplete)


def parameters(incomplete: str) -> list[str]:
    """Names, beginning with the incomplete word, of numbers that designs of the typed mechanism may vary.

    The speed is one of them; each has "=" behind it.
    """
    from analytic.description.changes import SPEED
    from comparisons.designer.parameters import parameters as known

    return _completions([f"{name}=" for linkage in _linkages() for name in (*known(linkage), SPEED)], incomplete)


def figures(incomplete: str) -> list[str]:
    """Names, beginning with the incomplete word, of figures of the typed mechanism's designs."""
    from analytic.designs.figures import figure_names
    from analytic.kinematics.mechanism import Mechanism

    return _completions([name for linkage in _linkages() for name in figure_names(Mechanism(linkage))], incomplete)


def axes(incomplete: str) -> list[str]:
    """Names of the stability maps that begin with the incomplete word."""
    from comparisons.trials.stress.cells import axes as known

    return _completions(known(), incomplete)


def _files_by_name() -> dict[str, Path]:
    """The linkage files that come with linkproof, of catalogue, gallery and literature, by their names."""
    return {path.stem: path for path in CATALOGUE.rglob("*.toml")}


def _completions(names: Iterable[str], incomplete: str) -> list[str]:
    """The names that begin with the incomplete word, sorted, each once."""
    return sorted({str(name) for name in names if str(name).startswith(incomplete)})


def _typed_files() -> list[Path]:
    """The linkage files named by the words typed so far, without program and command; one may not exist."""
    known = _files_by_name()
    return [known.get(word, Path(word)) for word in os.environ.get("COMP_WORDS", "").split()[2:]]


def _linkages() -> Iterator[Linkage]:
    """Yield the linkages among the typed words; those that cannot be read are left out."""
    from analytic.description.loading import load

    for file in _typed_files():
        with contextlib.suppress(LinkproofError):
            yield load(file)


def _linkage_tables() -> Iterator[dict[str, Any]]:
    """Yield the linkage files among the typed words as nested tables; those that cannot be read are left out."""
    for file in _typed_files():
        with contextlib.suppress(LinkproofError, ValueError, RecursionError):
            yield tomllib.loads(read_file(file, "a linkage file").decode("utf-8-sig"))


# How a shell asks for words, and how it learns to.

VARIABLE: Final = "_LINKPROOF_COMPLETE"
# Of a shell the file of completion in the home folder, and the file and the line by which it is read.
PLACES: Final = {
    "bash": (".bash_completions/linkproof.sh", ".bashrc", "source ~/.bash_completions/linkproof.sh"),
    "zsh": (".zfunc/_linkproof", ".zshrc", "fpath+=~/.zfunc; autoload -Uz compinit; compinit"),
    "fish": (".config/fish/completions/linkproof.fish", "", ""),
}


def complete(app: click.Group) -> int:
    """Print the words that may follow, or the script of completion, for the shell that asks; returns the exit code, 0.

    The shell and what it asks are in ``VARIABLE``. Raises LinkproofError for a shell without completion.
    """
    shell, _, action = os.environ[VARIABLE].partition("_")
    asked = _completer(app, shell)
    click.echo(asked.source() if action == "source" else asked.complete())
    return 0


def _completer(app: click.Group, shell: str) -> ShellComplete:
    """Click's object that completes for a shell, by its name, such as "bash".

    Raises LinkproofError for a shell without completion.
    """
    from click.shell_completion import get_completion_class

    kind = get_completion_class(shell)
    if kind is None:
        raise LinkproofError(f"expected a shell of {', '.join(PLACES)} in SHELL, got '{shell}': set it to yours")
    return kind(app, {}, "linkproof", VARIABLE)


def _teach(context: click.Context, parameter: click.Parameter, is_requested: bool) -> None:
    """Print the user's completion script, or write it where the shell finds it, and end the command.

    It is click's callback; without ``is_requested`` it does nothing. Raises LinkproofError for a shell without
    completion.
    """
    if not is_requested:
        return
    shell = Path(os.environ.get("SHELL", "")).name
    script = _completer(click.Group(), shell).source()
    if parameter.name == "install_completion":
        _install(shell, script)
    else:
        click.echo(script)
    context.exit()


def _install(shell: str, script: str) -> None:
    """Write the completion script where the shell finds it, and a line into the shell's settings that reads it.

    Prints the script's place. Raises KeyError for a shell that is not in ``PLACES``, OSError where a file cannot be
    written.
    """
    file, start, line = PLACES[shell]
    place = Path.home() / file
    place.parent.mkdir(parents=True, exist_ok=True)
    place.write_text(script, encoding="utf-8")
    settings = Path.home() / start
    if line and line not in (settings.read_text(encoding="utf-8") if settings.is_file() else ""):
        with settings.open("a", encoding="utf-8") as opened:
            opened.write(f"\n{line}\n")
    click.echo(f"wrote {place}; it takes effect in a new {shell}")


OPTIONS: Final = tuple(
    click.Option([flag], is_flag=True, is_eager=True, expose_value=False, callback=_teach, help=text)
    for flag, text in (
        ("--install-completion", "Install completion for the current shell."),
        ("--show-completion", "Show completion for the current shell, to copy it or customize the installation."),
    )
)
