"""The conformance test: does an adapter pass on its engine's results, by the contract's signs, frames and instants?"""
