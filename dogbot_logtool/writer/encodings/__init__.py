"""The registry of output encodings, and one file each."""
