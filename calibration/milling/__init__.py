"""How a robot mills: how it follows its path, how force and deflection arise, and what its motors tell of forces."""
