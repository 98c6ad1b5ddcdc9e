"""Pictures: charts described as data and drawn by matplotlib, kinematic schemes that stand and move."""
