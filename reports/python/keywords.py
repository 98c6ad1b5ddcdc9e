"""The declared options of a request as keywords of a function, each checked by its type."""

from __future__ import annotations

import inspect
import textwrap
from collections.abc import Callable, Iterable, Sequence
from dataclasses import is_dataclass
from functools import wraps
from numbers import Integral, Real
from pathlib import Path
from typing import Any, Final, TypeVar, get_args, get_type_hints

import numpy as np

from analytic.errors import LinkproofError, UnknownNameError, shortened
from reports.api.options import DeclaredOption, Option, declared_options, member_type

Result = TypeVar("Result")
Words = str | Iterable[str]  # a name, or several names
UNITS: Final = {"RPM": " of rpm", "SECONDS": " of s", "DEGREES": " of degrees", "GIB": " of GiB"}


def with_keywords(*, without: Sequence[str] = ()) -> Callable[[Callable[..., Result]], Callable[..., Result]]:
    """Decorator: replaces arguments that are dataclasses by a keyword for each option declared in them.

    Options ``without`` a keyword have their defaults. The function's signature and docstring list every keyword.
    """

    def decorated(function: Callable[..., Result]) -> Callable[..., Result]:
        hints = get_type_hints(function)
        signature = inspect.signature(function)
        option_classes: dict[str, Any] = {
            name: hints[name] for name in signature.parameters if is_dataclass(hints[name])
        }
        options = {
            name: {option.field.name: option for option in declared_options(kind) if _has_keyword(option, without)}
            for name, kind in option_classes.items()
        }
        every = {name: option for group in options.values() for name, option in group.items()}
        plain = [parameter for parameter in signature.parameters.values() if parameter.name not in option_classes]

        @wraps(function)
        def called(*args: Any, **given: Any) -> Result:  # noqa: ANN401 - of all keywords
            for name in given:
                if name not in every and name not in {parameter.name for parameter in plain}:
                    known = [*(parameter.name for parameter in plain), *every]
                    raise TypeError(str(UnknownNameError("argument", name, known)))
            for bag, group in options.items():
                values = {name: _value(option, given.pop(name)) for name, option in group.items() if name in given}
                given[bag] = option_classes[bag](**values)
            return function(*args, **given)

        way = inspect.Parameter.KEYWORD_ONLY
        added = [
            inspect.Parameter(n, way, default=option.field.default, annotation=option.kind)
            for n, option in every.items()
        ]
        called.__signature__ = signature.replace(parameters=[*plain, *added])  # type: ignore[attr-defined]
        lines = [
            textwrap.fill(f"{name}: {_keyword_help(option)}", 110, subsequent_indent="    ")
            for name, option in every.items()
        ]
        called.__doc__ = "\n".join(
            [inspect.cleandoc(function.__doc__ or ""), "", "Keywords of the command:", "", *lines]
        )
        return called

    return decorated


def _has_keyword(option: DeclaredOption, without: Sequence[str]) -> bool:
    return isinstance(option.info, Option) and option.field.name not in without


def _keyword_help(option: DeclaredOption) -> str:
    text = option.info.help if isinstance(option.info, Option) else ""
    return f"with False: {text}" if option.field.default is True else text


def _value(option: DeclaredOption, given: Any) -> Any:  # noqa: ANN401 - of any option
    """The value of a field; raises LinkproofError for a value of another type."""
    name, kinds = option.field.name, (option.kind, *get_args(option.kind))
    several = member_type(option.kind)
    if given is None and (type(None) in kinds or several is str):
        return option.field.default
    if several is float:
        return tuple(_number(name, each, option) for each in np.atleast_1d(np.asarray(given, dtype=object)).tolist())
    if several is not None:
        return words(given)
    if float in kinds or int in kinds:
        return _number(name, given, option)
    if bool in kinds and not isinstance(given, bool | np.bool_):
        raise LinkproofError(f"{name}: expected True or False, got {shortened(repr(given))}; pass one of them")
    if Path in kinds:
        return Path(given)
    return str(given) if str in kinds else given


def _number(name: str, value: Any, option: DeclaredOption) -> float:  # noqa: ANN401 - whatever is passed
    """A number; raises LinkproofError for anything else."""
    is_whole = int in (option.kind, *get_args(option.kind))
    if isinstance(value, bool | np.bool_) or not isinstance(value, Integral if is_whole else Real):
        what = "a whole number" if is_whole else "a number"
        unit = UNITS.get(option.info.metavar, "")
        raise LinkproofError(f"{name}: expected {what}{unit}, got {shortened(repr(value))}; pass a number")
    return value  # type: ignore[return-value]


def words(given: Words) -> tuple[str, ...]:
    """A name, or several names, as a tuple."""
    return (given,) if isinstance(given, str) else tuple(given)
