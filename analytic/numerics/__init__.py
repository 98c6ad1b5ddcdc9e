"""Methods that know no linkage: quadrature in time, periodic tables, extremes, roots."""
