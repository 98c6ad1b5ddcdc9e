"""Which engines are installed."""

from __future__ import annotations

from importlib import import_module, metadata


def installed_version(name: str) -> str | None:
    """Version of an installed engine; None where it is absent."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def why_absent(name: str) -> str | None:
    """Why an engine cannot be imported; an error inside an installed one is not hidden by this."""
    try:
        import_module(name)
    except ModuleNotFoundError as error:
        if error.name != name:
            raise
        return f"{name} is not installed: pip install 'linkproof[{name}]' brings it"
    return None
