"""The public API: a module is loaded when a name of it is used."""
