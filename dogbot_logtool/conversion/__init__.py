"""The annotated log: walk and chunks, planned, annotated, copied."""
