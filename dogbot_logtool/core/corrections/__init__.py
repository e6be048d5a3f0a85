"""What puts the samples of a recording right before anything is measured."""
