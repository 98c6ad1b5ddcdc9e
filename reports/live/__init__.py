"""The page that can be pulled at: a linkage computed anew in the browser, and its file with the new numbers."""
