"""Mid-ranging: a fast micro and a slow macro manipulator share one position, and the fast one returns to mid-travel."""
