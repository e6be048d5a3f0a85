"""Which topics are feet: by the robot's file, by the user's word, or by their names."""
