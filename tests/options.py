"""Options of several dataclasses out of one table of a test."""

from dataclasses import fields


def shared_out(given, *kinds):
    """An object of every class, of those of the given options that are its fields; no option is left over."""
    names = [{one.name for one in fields(kind)} for kind in kinds]
    assert {*given} <= set().union(*names), {*given} - set().union(*names)
    return [kind(**{name: given[name] for name in own & {*given}}) for kind, own in zip(kinds, names, strict=True)]
