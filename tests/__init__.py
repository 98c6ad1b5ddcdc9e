"""The tests; a package, since wheels of others (dartpy) bring a package of that name."""
