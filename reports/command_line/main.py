"""The entry of the command line: every error becomes one sentence and an exit code.

Exit codes: 0 all within limits, 1 a limit exceeded or a run that failed, 2 misuse, bad input or nothing judged, 3 a
fault of linkproof itself, 130 interrupted. Nothing but these is imported before ``main`` runs: from then on Ctrl-C
ends in a sentence.
"""

from __future__ import annotations

import errno
import gc
import os
import sys

from reports import BAD_INPUT, FAILED, INTERRUPTED, SUITE_ERROR


def main() -> None:
    """Run the command line and exit the process with its code; Ctrl-C too ends in a sentence."""
    try:
        _run_app()
    except KeyboardInterrupt as interrupt:
        _end_with_sentence(f"interrupted; {str(interrupt) or 'nothing was written'}", INTERRUPTED)


def _run_app() -> None:
    """Import and run the command line on ``sys.argv``, with the streams made safe first.

    Exits with its code, or prints a sentence on the error on stderr and exits with that error's code. Ctrl-C raises
    KeyboardInterrupt.
    """
    _start_fast()
    _open_closed_streams()
    from analytic.errors import LinkproofError
    from reports.command_line.app import app
    from reports.command_line.parameters import run
    from reports.document.numbers import accept_any_text

    accept_any_text()
    try:
        try:
            code = run(app, "linkproof", sys.argv[1:])
        finally:
            sys.stdout.flush()
    except LinkproofError as error:
        _end_with_sentence(str(error), BAD_INPUT)
    except BrokenPipeError:
        _discard(sys.stdout.fileno())
        sys.exit(0)
    except MemoryError:
        _end_with_sentence("out of memory: run fewer at once, or raise --memory-limit", FAILED)
    except Exception as error:
        _end_badly(error)
    else:
        sys.exit(code)


def _end_badly(error: Exception) -> None:
    """Print a sentence on an unexpected error on stderr, and exit.

    It blames the machine if that is the cause, with code 1 or 2, else linkproof, with code 3.
    """
    if isinstance(error, FileNotFoundError) and error.filename is None:
        _end_with_sentence("expected a working folder, got one that was deleted: change to another", BAD_INPUT)
    if isinstance(error, OSError) and error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO):
        _discard(sys.stdout.fileno())
        _end_with_sentence(
            f"cannot write to stdout: {error.strerror}; free some space, or write to a file elsewhere", BAD_INPUT
        )
    from comparisons.trials.runs.run_engine import Failure, lost

    fault = lost(error, 0)
    _end_with_sentence(fault.reason, SUITE_ERROR if fault.outcome is Failure.SUITE_ERROR else FAILED)


def _start_fast() -> None:
    """Speed up the start of this process: fewer garbage collections, no plugins of pydantic (by the environment).

    And make SIGTERM act as Ctrl-C.
    """
    import signal

    signal.signal(signal.SIGTERM, signal.default_int_handler)
    gc.set_threshold(50_000)
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")


def _open_closed_streams() -> None:
    """Replace stdout or stderr, if closed (>&-), by the null device, or a file opened later would get its number."""
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115 - open until the process ends


def _discard(descriptor: int) -> None:
    """Send what a stream has still to write to the null device, so that Python exits without an error.

    ``descriptor`` is the number of the stream's file.
    """
    os.dup2(os.open(os.devnull, os.O_WRONLY), descriptor)


def _end_with_sentence(sentence: str, code: int) -> None:
    """Print a sentence after "linkproof: " on stderr and exit with this code."""
    try:
        sys.stderr.write(f"linkproof: {sentence}\n")
        sys.stderr.flush()
    except OSError:  # a full disk: the exit code is all that can be said
        _discard(sys.stderr.fileno())
    sys.exit(code)


if __name__ == "__main__":
    main()
