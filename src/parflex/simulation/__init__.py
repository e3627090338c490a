"""The motion in time: controllers, loads, integration, results."""
