"""The guard between the controllers and the outputs; it shares no code with `control`."""
