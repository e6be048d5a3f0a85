"""Whether an inertial unit, the feet's forces and the base's poses agree."""
