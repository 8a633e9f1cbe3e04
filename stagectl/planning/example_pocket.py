"""A pocket to begin with: 30 x 30 cells of wood, with the durations that chapter 7 prints."""

EXAMPLE_POCKET = """\
{"rows": 30, "cols": 30, "G": 3, "feeds": "EW", "closed": true,
 "rate": {"E3": 0.075, "E2u": 0.0484, "E1u": 0.0442, "E2d": 0.054, "E1d": 0.0358,
          "W3": 0.0846, "W2u": 0.0652, "W1u": 0.037, "W2d": 0.0592, "W1d": 0.0368},
 "t_acc": 0, "step": 0, "t_lift": 0, "v_lift": 50, "theta": {}, "true": {}}
"""
"""A pocket's file; rates in s per cell along the feed (Sörnmo 2015, chapter 7, Experiment 1, as ms/mm^2)."""
