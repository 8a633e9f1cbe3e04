"""A look at the machine before something is led by it."""
