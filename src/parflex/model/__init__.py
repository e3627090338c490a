"""The door: checked calls of the models, and flat calls for control loops."""
