"""How a robot walks in two runs, or in a run and in its labels."""
