"""What feet felt, from every kind of message that tells it: one small adapter a message type."""
