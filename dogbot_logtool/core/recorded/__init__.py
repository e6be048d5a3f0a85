"""Recorders of topics beside feet and base, kept while they stream past."""
