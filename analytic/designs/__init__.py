"""Many designs of one linkage at once: numbers of its description that differ, and what comes of them."""
