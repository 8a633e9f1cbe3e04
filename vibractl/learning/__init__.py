"""The learning from shot to shot, in lines: what is believed, how much is dared, what is watched, and their law."""
