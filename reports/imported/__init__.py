"""Judgements of other tools' results, in words, tables and JSON."""
