"""Contact, force and base motion of logs without foot sensors or poses, by the legs' joints."""
