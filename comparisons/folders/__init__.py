"""Folders of campaigns that travel: judged anew, compared with one another, joined, written as tables."""
