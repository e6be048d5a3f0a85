"""The bytes of a log: on a disk, in a store, compressed."""
