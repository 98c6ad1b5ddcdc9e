"""Studies that the functions of ``linkproof`` return, of engines, trials and judged files, printed and saved alike."""
