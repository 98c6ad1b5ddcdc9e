"""The conformance test: does an adapter hand on what its engine says, by the contract's signs, frames and instants?"""
