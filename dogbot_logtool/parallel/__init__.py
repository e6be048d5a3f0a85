"""Several batches at once, in processes or threads, with results in order."""
