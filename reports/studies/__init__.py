"""What the functions of ``linkproof`` return: a class of each study, all of them printed, saved and judged alike."""
