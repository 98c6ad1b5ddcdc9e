"""The conformance test: whether an adapter passes on its engine's results by the contract's signs, frames, instants."""
