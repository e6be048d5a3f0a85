"""Messages that we add, made of columns: one file a kind."""
