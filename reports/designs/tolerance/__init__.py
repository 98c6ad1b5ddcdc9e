"""Tables and pictures of a study of tolerances."""
