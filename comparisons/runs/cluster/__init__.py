"""Jobs on many machines: the workers of a Dask scheduler, each engine run still in a process of its own."""
