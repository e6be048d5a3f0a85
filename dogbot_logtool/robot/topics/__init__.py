"""Which topics of a log are used for what."""
