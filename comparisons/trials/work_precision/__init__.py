"""Error against run time: methods, settings, orders, floors and fronts."""
