"""The input gate: what a sample must be before it may touch the controllers."""
