"""Making runs: worker processes with bounds, here or on a cluster, the store of what is finished, files."""
