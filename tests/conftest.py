import os

from hypothesis import HealthCheck, settings

# How long an example takes says more of the machine than of the code.
settings.register_profile("untimed", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("untimed")

# pytest-xdist sets these, and programs that are started would take their output for a terminal's.
for name in ("COLUMNS", "LINES"):
    os.environ.pop(name, None)
