"""Many logs: several at once, by processes of this machine or by a cluster."""
