"""exudyn behind the contract."""
