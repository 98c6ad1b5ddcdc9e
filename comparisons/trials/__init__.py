"""Runs of engines: made, stored, judged; campaigns, benchmarks, stability maps, the check of an adapter."""
