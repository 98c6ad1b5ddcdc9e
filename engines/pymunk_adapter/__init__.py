"""pymunk behind the contract."""
