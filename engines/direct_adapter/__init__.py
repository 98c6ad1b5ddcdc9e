"""The suite's own second derivation behind the contract: constrained bodies, every instant solved exactly."""
