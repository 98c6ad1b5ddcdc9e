"""The commands about many designs of one linkage: ``linkproof sweep | optimise | tolerance``.

They are added to the commands of ``app``; what they need is imported when they run.
"""

from __future__ import annotations
