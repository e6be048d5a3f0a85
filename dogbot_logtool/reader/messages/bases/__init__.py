"""Where poses of the base come from: one file a kind of message."""
