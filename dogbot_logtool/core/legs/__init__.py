"""What a robot's legs do: swings of the feet, and motion, torque and work of the joints."""
