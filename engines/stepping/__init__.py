"""The way from time steps to a history, shared by all adapters of engines that take steps."""
