"""The command line, as ``python -m linkproof``."""

from reports.command_line.main import main

if __name__ == "__main__":
    main()
