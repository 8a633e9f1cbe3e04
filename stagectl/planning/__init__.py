"""The order in which a pocket is milled: the problem, planners that learn, and the optimum."""
