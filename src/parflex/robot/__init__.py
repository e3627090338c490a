"""What a robot is: plain data."""
