"""Contacts of feet from every kind of message: one small adapter a message type."""
