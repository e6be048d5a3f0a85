"""The steps of `batches.py`: what is read of a batch, what passes between, what is drawn."""
