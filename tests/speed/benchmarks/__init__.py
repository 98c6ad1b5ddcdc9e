"""The hot paths of linkproof, timed by asv at two commits; asv needs this file."""
