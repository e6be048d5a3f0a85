"""One HTML page a log, which draws itself wherever it is opened."""
