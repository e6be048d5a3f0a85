"""What puts samples right before anything is measured: clocks, sensors, frames."""
