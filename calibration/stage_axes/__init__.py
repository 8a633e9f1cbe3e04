"""The stage's axes identified: chirps with open and with closed inner loop, models for the controllers, a report."""
