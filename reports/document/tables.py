"""The names that a table and its Markdown had before there were parts."""

from reports.document.markdown import table as markdown
from reports.document.parts import Table as ReportTable

__all__ = ["ReportTable", "markdown"]
