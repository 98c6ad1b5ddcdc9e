"""The command line: ``linkproof``, and ``python -m linkproof``."""

from linkproof import refuse_strangers


def main() -> None:
    """Run the command line of ``sys.argv`` and exit the process with its code.

    Raises ImportError first if another package stands in the place of one of linkproof's, or one is missing.
    """
    refuse_strangers()
    from reports.command_line.main import main as run  # noqa: PLC0415  not a stranger's

    run()


if __name__ == "__main__":
    main()
