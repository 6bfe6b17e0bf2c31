"""A simulated main compute: vehicle, courses, planner, and the loops that join them."""
