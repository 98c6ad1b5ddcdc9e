"""Making runs: worker processes with bounds, the journal of what is finished, files."""
