"""The island's life cycle: from conditions to a state, and what each state lets out."""
