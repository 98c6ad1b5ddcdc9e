"""Requests of users: the declared options, and the computations that they select."""
